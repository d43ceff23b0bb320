#include "lib/irradcache/points.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/photons/photons.h"
#include "lib/core/arrays.h"
#include "lib/core/statistics.h"
#include "lib/density/irradiance_estimate.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kNormalBins = 8;  ///< bins per octahedral coordinate
/// Smallest cosine between a cell's direction and a point's normal. A bin is up to 50 degrees wide, so 60 degrees from
/// its middle leave out no normal of the bin.
constexpr float kFacesCell = 0.5f;
constexpr int kCandidates = 8;  ///< points around a hit that are tried
constexpr int kMaxProbes = 16;  ///< entries of the table that are tried for a cell
constexpr float kCellsPerSpacing = 1.4f;
constexpr int kCellBits = 19;          ///< bits of a cell's number along an axis
constexpr float kRounding = 0x1p-20f;  ///< relative rounding of coordinates

constexpr float kBeside = 1.5f;  ///< spacings: distance within which points count as neighbours
constexpr double kPhotons = IrradianceOptions{}.neighbours;  ///< photons of an estimate
constexpr std::size_t kProof =
    2;  ///< neighbours without which direct light is not uniform; on a wide surface a point has 7

/// Bin of a normal: 3 bits of each octahedral coordinate.
std::uint32_t normal_bin(Vec3 n) {
  const float scale = 1 / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  float u = n.x * scale, v = n.y * scale;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * std::copysign(1.0f, u);
    v = (1 - std::abs(u)) * std::copysign(1.0f, v);
    u = folded;
  }
  const auto bin = [](float x) { return std::min(kNormalBins - 1, std::uint32_t((x + 1) * (0.5f * kNormalBins))); };
  return bin(u) * kNormalBins + bin(v);
}

Vec3 bin_direction(std::uint32_t bin) {
  const auto middle = [](std::uint32_t i) { return (2 * float(i) + 1) / kNormalBins - 1; };
  Vec3 n{middle(bin / kNormalBins), middle(bin % kNormalBins), 0};
  n.z = 1 - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0) {
    const float folded = (1 - std::abs(n.y)) * std::copysign(1.0f, n.x);
    n.y = (1 - std::abs(n.x)) * std::copysign(1.0f, n.y);
    n.x = folded;
  }
  return normalize(n);
}

}  // namespace

PointLookup::PointLookup(std::span<const IrradiancePoint> points, float spacing, ClearanceTest look)
    : points_(points),
      look_(std::move(look)),
      spacing_(spacing),
      inverse_cell_(kCellsPerSpacing / spacing),
      lights_(points.size()),
      mask_(std::bit_ceil(std::max<std::size_t>(1 << 12, 4 * points.size())) - 1),
      entries_(std::make_unique<Entry[]>(mask_ + 1)) {
  std::vector<formats::Photon> as_photons(points.size());  // PhotonIndex finds photons
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IrradiancePoint& p = points[i];
    widest_ = std::max(widest_, p.radius);
    as_photons[i].position = array_of(p.position);
    as_photons[i].normal = formats::encode_normal(array_of(p.normal));
    lights_[i].position = p.position;
    lights_[i].normal = p.normal;
    lights_[i].all = p.total();
    lights_[i].radius = p.radius;
    lights_[i].point = std::uint32_t(i);
  }
  index_ = PhotonIndex(as_photons);
}

PointLookup::Question PointLookup::ask(Vec3 position, Vec3 normal) const {
  Question question{position, normal, 1};
  for (int a = 0; a < 3; ++a) {
    constexpr std::int64_t kMiddle = 1 << (kCellBits - 1);
    const float along = std::floor(position[a] * inverse_cell_);
    if (!(std::abs(along) < float(kMiddle))) return {position, normal, 0};
    question.cell = question.cell << kCellBits | std::uint64_t(std::int64_t(along) + kMiddle);
  }
  question.cell = question.cell << 6 | normal_bin(normal);
  __builtin_prefetch(&entries_[mix64(question.cell) & mask_]);
  return question;
}

bool PointLookup::represents(const Light& light, const Question& q) const {
  if (!look_) return dot(light.normal, q.normal) > 0;
  const Vec3 d = q.position - light.position;
  const float reach = kReach * spacing_;
  if (!(length2(d) < reach * reach) || !(dot(light.normal, q.normal) > Clearance::kBend) ||
      std::abs(dot(d, light.normal + q.normal)) >
          2 * (Clearance::kOffPlane * length(d) + kRounding * max_component(abs(q.position))))
    return false;  // the hit is above or below the spokes, so another surface may lie between
  Clearance::Shares shares{light.clearance[0].load(std::memory_order_relaxed),
                           light.clearance[1].load(std::memory_order_relaxed)};
  if (shares[0] == kNotLooked || shares[1] == kNotLooked) {
    shares = look_(light.position, light.normal, reach).shares;
    for (std::size_t i = 0; i < 2; ++i)
      light.clearance[i].store(shares[i] = std::max<std::uint64_t>(1, shares[i]), std::memory_order_relaxed);
  }
  return Clearance{reach, shares}.contains(d, light.normal);
}

/// The point closest to the middle of a cell, among the points that face the cell's direction, + 1; 0: there is none.
std::uint32_t PointLookup::search_cell(std::uint64_t cell) const {
  thread_local NeighbourList found;
  Vec3 middle;
  for (int a = 0; a < 3; ++a) {
    const std::uint64_t along = cell >> (6 + (2 - a) * kCellBits) & ((1 << kCellBits) - 1);
    middle[a] = (float(std::int64_t(along) - (1 << (kCellBits - 1))) + 0.5f) / inverse_cell_;
  }
  index_.find_nearest({middle, bin_direction(std::uint32_t(cell & 63)), INFINITY, kFacesCell}, 1, found);
  return found.count() == 0 ? 0 : index_.source(found.photons()[0]) + 1;
}

/// The closest point that represents the hit, or nullptr.
const PointLookup::Light* PointLookup::search(const Question& q) const {
  thread_local NeighbourList found;
  PhotonQuery query{q.position, q.normal, INFINITY, 0};
  if (look_) query.max_radius = kReach * spacing_, query.min_cos = Clearance::kBend;
  index_.find_nearest(query, kCandidates, found);
  found.sort_by_distance();
  for (const std::uint32_t i : found.photons())
    if (const Light& light = lights_[index_.source(i)]; represents(light, q)) return &light;
  return nullptr;
}

const PointLookup::Light* PointLookup::nearest(Vec3 position, Vec3 normal) const {
  thread_local NeighbourList found;
  index_.find_nearest({position, normal, INFINITY, 0}, 1, found);
  return found.count() == 0 ? nullptr : &lights_[index_.source(found.photons()[0])];
}

bool PointLookup::apart(const IrradiancePoint& bright, const IrradiancePoint& dark) const {
  if (!(bright.radius > 0 && bright.radius < widest_)) return false;
  const double there = double(channel_sum(bright.indirect)), here = double(channel_sum(dark.indirect));
  const double wider = double(dark.radius > 0 ? dark.radius : widest_) / double(bright.radius);
  const double one = there / (kPhotons * wider * wider), c = kContrastOfIndirect;
  const double beyond = there - c * here;
  return beyond > 0 &&
         beyond * beyond > kCertain * kCertain * (there * there / kPhotons + c * c * (here * one + one * one));
}

std::uint8_t PointLookup::compare_neighbours(const Light& light) const {
  thread_local NeighbourList found;
  index_.find_within({light.position, light.normal, kBeside * spacing_, Clearance::kBend}, found);
  struct Range {
    float least = INFINITY, most = 0;
    void add(Rgb light) {
      least = std::min(least, channel_sum(light));
      most = std::max(most, channel_sum(light));
    }
    bool even() const { return !(least * kContrast < most); }
  } direct, indirect;
  thread_local std::vector<std::uint32_t> beside;
  beside.clear();
  for (const std::uint32_t i : found.photons())
    if (index_.source(i) != light.point) beside.push_back(index_.source(i));
  for (const std::uint32_t i : beside) {
    direct.add(points_[i].direct);
    indirect.add(points_[i].indirect);
  }
  const bool proven = beside.size() >= kProof;
  // A point hidden behind the surface, as on the other face of a double wall, is not a neighbour. Usually it belongs to
  // another object.
  std::erase_if(beside, [&](std::uint32_t i) { return points_[i].object != points_[light.point].object; });
  const bool torn = !indirect.even() && std::any_of(beside.begin(), beside.end(), [&](std::uint32_t bright) {
    return std::any_of(beside.begin(), beside.end(),
                       [&](std::uint32_t dark) { return apart(points_[bright], points_[dark]); });
  });
  const auto uneven = std::uint8_t(kKnown | (direct.even() && proven ? 0 : kDirect) | (torn ? kIndirect : 0));
  light.uneven.store(uneven, std::memory_order_relaxed);
  return uneven;
}

/// The slow part of answer(), for questions that the first entry of the table does not answer. Reads a later entry, or
/// searches the cell and stores the result.
std::uint32_t PointLookup::find_answer(const Question& q) const {
  if (q.cell == 0) {
    const Light* light = search(q);
    return light ? light->point + 1 : 0;
  }
  std::size_t slot = mix64(q.cell) & mask_;
  for (int probe = 0; probe < kMaxProbes; ++probe, slot = (slot + 1) & mask_) {
    Entry& entry = entries_[slot];
    std::uint64_t there = entry.cell.load(std::memory_order_relaxed);
    if (there == 0 && entry.cell.compare_exchange_strong(there, q.cell, std::memory_order_relaxed)) there = q.cell;
    if (there != q.cell) continue;
    // Another thread may search the same cell at the same time; both find the same point.
    if (const std::uint32_t known = entry.answer.load(std::memory_order_relaxed)) return known - 1;
    const std::uint32_t found = search_cell(q.cell);
    entry.answer.store(found + 1, std::memory_order_relaxed);
    return found;
  }
  return search_cell(q.cell);
}

}  // namespace tempolux
