#include "lib/irradcache/points.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/photons/photons.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr float kSameSide = 0.5f;          ///< cosine between a cell's direction and a point's normal, at least
constexpr int kCandidates = 8;             ///< nearest points among which one of the same object is looked for
constexpr int kMoreCandidates = 64;        ///< where none of the nearest can be reached
constexpr int kMaxProbes = 16;
constexpr std::uint32_t kNormalBins = 8;   ///< per octahedral coordinate
constexpr float kCellsPerSpacing = 1.4f;
constexpr float kMostCells = 16000;        ///< per axis: 14 bits in the key
constexpr float kNeighbourhood = 2.5f;     ///< spacings: how far the neighbours are that a point must reach
constexpr std::uint32_t kSeparated = 0x80000000u;

/// 3 bits of each octahedral coordinate; n need not be encoded to the last bit for that.
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

PointLookup::PointLookup(std::span<const IrradiancePoint> points, const Box3& bounds, float spacing, ReachTest reach)
    : points_(points), reach_(std::move(reach)), lower_(bounds.lower), spacing_(spacing) {
  std::vector<formats::Photon> as_photons(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IrradiancePoint& p = points[i];
    as_photons[i].position = {p.position.x, p.position.y, p.position.z};
    as_photons[i].normal = formats::encode_normal({p.normal.x, p.normal.y, p.normal.z});
  }
  index_ = PhotonIndex(as_photons);
  const float extent = bounds.empty() ? 1 : max_component(bounds.upper - bounds.lower);
  cell_ = std::max(spacing / kCellsPerSpacing, extent / kMostCells);
  inverse_cell_ = 1 / cell_;
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(1 << 12, 8 * points.size()));
  mask_ = capacity - 1;
  entries_ = std::make_unique<Entry[]>(capacity);
  if (reach_) separated_ = std::make_unique<std::atomic<std::uint8_t>[]>(points.size());
}

/// The nearest point of the object among the nearest few, else the nearest of all.
std::uint32_t PointLookup::search(Vec3 position, Vec3 normal, std::uint32_t object) const {
  thread_local NeighbourList found;
  PhotonQuery query;
  query.point = position;
  query.normal = normal;
  query.min_cos = kSameSide;
  index_.find_nearest(query, kCandidates, found);
  if (found.count() == 0) return 1;
  found.sort_by_distance();
  for (std::uint32_t i : found.photons())
    if (points_[index_.source(i)].object == object) return index_.source(i) + 2;
  return index_.source(found.photons()[0]) + 2;
}

std::uint32_t PointLookup::search_cell(const std::uint32_t cell[3], std::uint32_t bin, std::uint32_t object) const {
  const Vec3 middle =
      lower_ + Vec3{float(cell[0]) + 0.5f, float(cell[1]) + 0.5f, float(cell[2]) + 0.5f} * cell_;
  const std::uint32_t value = search(middle, bin_direction(bin), object);
  return reach_ && value > 1 && separated(value - 2) ? value | kSeparated : value;
}

/// Is there a neighbour, facing the same way, that the point cannot reach?
bool PointLookup::separated(std::uint32_t i) const {
  if (const std::uint8_t known = separated_[i].load(std::memory_order_relaxed)) return known == 2;
  thread_local NeighbourList found;
  const IrradiancePoint& point = points_[i];
  PhotonQuery query;
  query.point = point.position;
  query.normal = point.normal;
  query.min_cos = kSameSide;
  query.max_radius = kNeighbourhood * spacing_;
  index_.find_within(query, found);
  bool all = true;
  for (std::size_t n = 0; all && n < found.count(); ++n) {
    const IrradiancePoint& other = points_[index_.source(found.photons()[n])];
    all = &other == &point || reach_(point.position, point.normal, other.position, other.normal);
  }
  separated_[i].store(all ? 1 : 2, std::memory_order_relaxed);
  return !all;
}

/// The nearest point that can be reached from the hit, one of the same object first; if there is none, as search().
std::uint32_t PointLookup::search_reachable(Vec3 position, Vec3 normal, std::uint32_t object) const {
  thread_local NeighbourList found;
  PhotonQuery query;
  query.point = position;
  query.normal = normal;
  query.min_cos = kSameSide;
  for (int candidates : {kCandidates, kMoreCandidates}) {
    index_.find_nearest(query, candidates, found);
    found.sort_by_distance();
    for (bool same : {true, false})
      for (std::uint32_t i : found.photons()) {
        const IrradiancePoint& point = points_[index_.source(i)];
        if ((point.object == object) == same && reach_(position, normal, point.position, point.normal))
          return index_.source(i) + 2;
      }
  }
  return search(position, normal, object);
}

const IrradiancePoint* PointLookup::find(Vec3 position, Vec3 normal, std::uint32_t object) const {
  const Vec3 local = (position - lower_) * inverse_cell_;
  const auto coordinate = [](float x) { return std::uint32_t(std::clamp(x, 0.0f, 16383.0f)); };
  const std::uint32_t cell[3]{coordinate(local.x), coordinate(local.y), coordinate(local.z)};
  const std::uint32_t bin = normal_bin(normal);
  // 3 x 14 bits of cell, 6 of direction, 16 of object (formats and photons number no more). All ones is no cell's.
  const std::uint64_t key = (std::uint64_t(cell[0]) << 50 | std::uint64_t(cell[1]) << 36 | std::uint64_t(cell[2]) << 22 |
                             std::uint64_t(bin) << 16 | (object & 0xffff)) + 1;
  const auto answer = [&](std::uint32_t value) -> const IrradiancePoint* {
    if (value & kSeparated) value = search_reachable(position, normal, object);
    return value > 1 ? &points_[value - 2] : nullptr;
  };

  std::size_t slot = mix64(key) & mask_;
  for (int probe = 0; probe < kMaxProbes; ++probe, slot = (slot + 1) & mask_) {
    Entry& entry = entries_[slot];
    std::uint64_t there = entry.key.load(std::memory_order_acquire);
    if (there != 0 && there != key) continue;
    if (there == key)
      if (const std::uint32_t value = entry.value.load(std::memory_order_acquire)) return answer(value);
    const std::uint32_t value = search_cell(cell, bin, object);
    if (there == 0 && !entry.key.compare_exchange_strong(there, key) && there != key) continue;
    entry.value.store(value, std::memory_order_release);
    return answer(value);
  }
  return answer(search_cell(cell, bin, object));
}

}  // namespace tempolux
