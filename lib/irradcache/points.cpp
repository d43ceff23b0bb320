#include "lib/irradcache/points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "formats/photons/photons.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr float kSameSide = 0.5f;    ///< cosine between a cell's direction and a point's normal, at least
constexpr int kCandidates = 8;       ///< nearest points among which one of the same object is looked for
constexpr int kMoreCandidates = 64;  ///< where none of the nearest can be reached
constexpr int kMaxProbes = 16;
constexpr float kCellsPerSpacing = 1.4f;
constexpr float kNeighbourhood = 2.5f;    ///< spacings: how far the neighbours are that a point must reach
constexpr float kCellDiagonal = 1.4142f;  ///< of a cell's section along a surface
constexpr float kHot = 20;        ///< times the mean: light of which little must not be read beside where it falls
constexpr float kContrast = 8;    ///< to a neighbour, from which on neither stands for what lies between them
constexpr float kShadow = 64;     ///< the same of direct light: a shadow that nothing else lights
constexpr float kOnePlane = 0.95f;  ///< cosine between normals: what faces elsewhere is not in a shadow's edge
constexpr float kBeside = 1.5f;   ///< spacings: how far off the point is that a hit may read

Vec3 bin_direction(std::uint32_t bin) {
  const auto middle = [](std::uint32_t i) { return (2 * float(i) + 1) / PointLookup::kNormalBins - 1; };
  Vec3 n{middle(bin / PointLookup::kNormalBins), middle(bin % PointLookup::kNormalBins), 0};
  n.z = 1 - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0) {
    const float folded = (1 - std::abs(n.y)) * std::copysign(1.0f, n.x);
    n.y = (1 - std::abs(n.x)) * std::copysign(1.0f, n.y);
    n.x = folded;
  }
  return normalize(n);
}

/// Asks for points about `position` that face the same way as `normal`.
PhotonQuery facing(Vec3 position, Vec3 normal) {
  PhotonQuery query;
  query.point = position;
  query.normal = normal;
  query.min_cos = kSameSide;
  return query;
}

}  // namespace

/// The points nearest to the middle of a cell: among them its hits look for one that they can reach. Not
/// initialised: the memory of crowds that no hit asks for is never touched.
struct PointCrowd {
  static constexpr int kMost = 10;
  int count, same;  ///< the first `same` of `count` are of the cell's object
  float x[kMost], y[kMost], z[kMost];
  std::uint32_t point[kMost];
};

PointLookup::~PointLookup() = default;

PointLookup::PointLookup(std::span<const IrradiancePoint> points, const Box3& bounds, float spacing,
                         ReachTest reach)
    : points_(points),
      reach_(std::move(reach)),
      lower_(bounds.empty() ? Vec3{} : bounds.lower),
      spacing_(spacing) {
  std::vector<formats::Photon> as_photons(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IrradiancePoint& p = points[i];
    as_photons[i].position = {p.position.x, p.position.y, p.position.z};
    as_photons[i].normal = formats::encode_normal({p.normal.x, p.normal.y, p.normal.z});
    as_photons[i].object = std::uint16_t(p.object);  // its lower half will do to prefer a point
  }
  index_ = PhotonIndex(as_photons);
  for (std::size_t i = 0; i < points.size(); ++i) {
    lights_.push_back({points[i].total(), points[i].radius, points[i].direct + points[i].caustic, std::uint32_t(i) & 0x7fffffffu, 0});
    objects_ = std::max(objects_, points[i].object + 2);  // one more for all objects without points
  }
  mark_hot_edges();
  mark_shadow_edges();
  value_bits_ = int(std::bit_width(2 * (points.size() + 1)));  // a point + 1 or a crowd + 1, and kSeparated
  const Vec3 extent = bounds.empty() ? Vec3{1, 1, 1} : bounds.upper - bounds.lower;
  cell_ = std::max(spacing / kCellsPerSpacing, max_component(extent) / PointLookup::kMostCells);
  for (double keys = INFINITY; !(keys < std::ldexp(1.0, 63 - value_bits_)); cell_ *= 1.1f) {
    keys = double(objects_) * PointLookup::kNormalBins * PointLookup::kNormalBins;
    inverse_cell_ = 1 / cell_;
    for (int a = 0; a < 3; ++a) {
      size_[std::size_t(a)] = std::uint32_t(std::max(0.0f, extent[a] * inverse_cell_)) + 1;
      keys *= size_[std::size_t(a)];
    }
  }
  cell_ = 1 / inverse_cell_;
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(1 << 12, 4 * points.size()));
  mask_ = capacity - 1;
  entries_ = std::make_unique<std::atomic<std::uint64_t>[]>(capacity);
  if (!reach_) return;
  separated_ = std::make_unique<std::atomic<std::uint8_t>[]>(points.size());
  crowds_ = std::make_unique_for_overwrite<PointCrowd[]>(points.size());
}

/// Points at the edges of spots much brighter than the mean (the gap between a lamp and the ceiling above it) get an infinite
/// radius: hits near them continue, whatever their distance. Read instead, a spacing's width of the spot would be seen
/// beside it: a gap of a tenth of the spacing brought 28 % more indirect light to a room.
void PointLookup::mark_hot_edges() {
  double sum = 0;
  for (const PointLight& point : lights_) sum += double(channel_sum(point.all));
  const double mean = sum / double(std::max<std::size_t>(1, lights_.size()));
  NeighbourList found;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const float here = channel_sum(lights_[i].all);
    if (!(double(here) > kHot * mean)) continue;
    PhotonQuery query = facing(points_[i].position, points_[i].normal);
    query.max_radius = kNeighbourhood * spacing_;
    index_.find_within(query, found);
    for (const std::uint32_t other : found.photons())
      if (PointLight& there = lights_[index_.source(other)]; channel_sum(there.all) * kContrast < here)
        there.radius = lights_[i].radius = INFINITY;
  }
}

/// Points where some of those beside lie in the light and others in the dark: at hits near them direct light is sampled, one
/// shadow ray. Read instead, light reaches a spacing into shadows, where much of what sees it is: the ground in a chair's shadow
/// is seen by the chair. A point's own light has no say in whether it is read: it is known by a few shadow rays, and were those
/// that came out bright replaced, what is read would be dark in the mean (a pair of thin sheets sent 4 % less to the ground).
void PointLookup::mark_shadow_edges() {
  double sum = 0;
  for (const IrradiancePoint& point : points_) sum += double(channel_sum(point.direct));
  const double mean = sum / double(std::max<std::size_t>(1, points_.size()));
  if (!(mean > 0)) return;
  const float beside = kBeside * spacing_;
  NeighbourList found;
  std::vector<std::uint32_t> near, dark;   // points
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const float here = channel_sum(points_[i].direct);
    if (!(double(here) > mean)) continue;
    PhotonQuery query = facing(points_[i].position, points_[i].normal);
    query.min_cos = kOnePlane;
    query.max_radius = beside;
    index_.find_within(query, found);
    near.clear();
    dark.clear();
    for (const std::uint32_t other : found.photons()) {
      const std::uint32_t there = index_.source(other);
      if (there == i) continue;
      near.push_back(there);
      if (channel_sum(points_[there].direct) * kShadow < here) dark.push_back(there);
    }
    if (dark.empty()) continue;
    for (const std::uint32_t at : near)
      for (const std::uint32_t other : dark)
        if (other != at && length2(points_[other].position - points_[at].position) < beside * beside) {
          lights_[at].shadow_edge = 1;
          break;
        }
  }
}

/// The nearest point of the object among the nearest few, else the nearest of all.
std::uint32_t PointLookup::search(Vec3 position, Vec3 normal, std::uint32_t object) const {
  thread_local NeighbourList found;
  const PhotonQuery query = facing(position, normal);
  const auto same = [&](std::uint32_t i) { return index_.object(i) == std::uint16_t(object); };
  index_.find_nearest(query, 1, found);
  if (found.count() == 0) return 0;
  const std::uint32_t nearest = found.photons()[0];
  if (same(nearest)) return index_.source(nearest) + 1;
  index_.find_nearest(query, kCandidates, found);
  found.sort_by_distance();
  for (std::uint32_t i : found.photons())
    if (same(i)) return index_.source(i) + 1;
  return index_.source(nearest) + 1;
}

/// The answer of a cell, doubled: 0 or point + 1; or with kSeparated, if its hits are to be answered one by one,
/// 0 or crowd + 1.
std::uint32_t PointLookup::search_cell(Vec3 middle, std::uint32_t bin, std::uint32_t object) const {
  const Vec3 direction = bin_direction(bin);
  const std::uint32_t found = search(middle, direction, object);
  if (!reach_ || !found || !separated(found - 1) || !cut(middle, found - 1)) return 2 * found;
  return 2 * remember_crowd(middle, direction, object) + kSeparated;
}

/// Is there a point that may be the nearest to some place of a cell, and `nearest` cannot reach it?
bool PointLookup::cut(Vec3 middle, std::uint32_t nearest) const {
  thread_local NeighbourList found;
  const IrradiancePoint& point = points_[nearest];
  PhotonQuery query = facing(middle, point.normal);
  query.max_radius = length(point.position - middle) + kCellDiagonal * cell_;
  index_.find_within(query, found);
  for (std::uint32_t i : found.photons())
    if (!(index_.position(i) == point.position) &&
        !reach_(point.position, point.normal, index_.position(i), normalize(index_.normal(i))))
      return true;
  return false;
}

/// Is there a neighbour, facing the same way, that the point cannot reach?
bool PointLookup::separated(std::uint32_t i) const {
  if (const std::uint8_t known = separated_[i].load(std::memory_order_relaxed)) return known == 2;
  thread_local NeighbourList found;
  const IrradiancePoint& point = points_[i];
  PhotonQuery query = facing(point.position, point.normal);
  query.max_radius = kNeighbourhood * spacing_;
  index_.find_within(query, found);
  bool all = true;
  for (std::size_t n = 0; all && n < found.count(); ++n) {
    const std::uint32_t other = found.photons()[n];  // from the index: in order, the points are not
    all = index_.position(other) == point.position ||
          reach_(point.position, point.normal, index_.position(other), normalize(index_.normal(other)));
  }
  separated_[i].store(all ? 1 : 2, std::memory_order_relaxed);
  return !all;
}

/// The points near the middle of a cell, nearest first, those of the object before the others; 0 or crowd + 1.
std::uint32_t PointLookup::remember_crowd(Vec3 middle, Vec3 normal, std::uint32_t object) const {
  if (crowd_count_.load(std::memory_order_relaxed) >= points_.size()) return 0;
  const std::uint32_t number = crowd_count_.fetch_add(1, std::memory_order_relaxed);
  if (number >= points_.size()) return 0;
  thread_local NeighbourList found;
  const PhotonQuery query = facing(middle, normal);
  index_.find_nearest(query, PointCrowd::kMost, found);
  found.sort_by_distance();
  PointCrowd& crowd = crowds_[number];
  crowd = {};
  for (bool same : {true, false})
    for (std::uint32_t i : found.photons()) {
      const IrradiancePoint& point = points_[index_.source(i)];
      if ((point.object == object) != same) continue;
      const int n = crowd.count++;
      crowd.x[n] = point.position.x;
      crowd.y[n] = point.position.y;
      crowd.z[n] = point.position.z;
      crowd.point[n] = index_.source(i);
      crowd.same += same;
    }
  return number + 1;
}

/// The nearest that can be reached from the hit, one of the same object first; 0 or point + 1.
std::uint32_t PointLookup::reachable_in(const PointCrowd& crowd, const Question& q) const {
  float distance2[PointCrowd::kMost];
  for (int i = 0; i < PointCrowd::kMost; ++i)
    distance2[i] = length2(Vec3{crowd.x[i], crowd.y[i], crowd.z[i]} - q.position);
  for (const auto& [first, last] : {std::pair{0, crowd.same}, std::pair{crowd.same, crowd.count}})
    for (int tries = first; tries < last; ++tries) {
      int nearest = first;
      float least = distance2[first];
      for (int i = first + 1; i < last; ++i) {
        const bool nearer = distance2[i] < least;
        least = nearer ? distance2[i] : least;
        nearest = nearer ? i : nearest;
      }
      const IrradiancePoint& point = points_[crowd.point[nearest]];
      if (reach_(q.position, q.normal, point.position, point.normal)) return crowd.point[nearest] + 1;
      distance2[nearest] = INFINITY;
    }
  return 0;
}

/// The same without a crowd (nullptr), or where none of it can be reached; in the end as search().
std::uint32_t PointLookup::search_reachable(const Question& q, const PointCrowd* tried) const {
  thread_local NeighbourList found;
  const PhotonQuery query = facing(q.position, q.normal);
  const auto was_tried = [tried](std::uint32_t point) {
    return tried && std::find(tried->point, tried->point + tried->count, point) != tried->point + tried->count;
  };
  std::size_t done = 0;   // of the nearest: looked at in the round before
  for (int candidates : {kCandidates, kMoreCandidates}) {
    index_.find_nearest(query, candidates, found);
    found.sort_by_distance();
    for (bool same : {true, false})
      for (std::uint32_t i : found.photons().subspan(std::min(done, found.count()))) {
        const std::uint32_t there = index_.source(i);
        const IrradiancePoint& point = points_[there];
        if ((point.object == q.object) == same && !was_tried(there) &&
            reach_(q.position, q.normal, point.position, point.normal))
          return there + 1;
      }
    done = found.count();
  }
  return search(q.position, q.normal, q.object);
}

/// Of a cell that something separates: what this hit can reach.
const PointLight* PointLookup::read_one_by_one(const Question& q, Answer answer) const {
  const PointCrowd* crowd = answer.value / 2 ? &crowds_[answer.value / 2 - 1] : nullptr;
  std::uint32_t found = crowd ? reachable_in(*crowd, q) : 0;
  if (!found) found = search_reachable(q, crowd);
  return found ? &lights_[found - 1] : nullptr;
}

/// Where the first place of the table does not tell: a further one does, or the cell is searched and remembered.
PointLookup::Answer PointLookup::answer_anew(const Question& q) const {
  const std::uint64_t value_mask = (std::uint64_t(1) << value_bits_) - 1;
  std::size_t slot = mix64(q.key) & mask_;
  std::atomic<std::uint64_t>* empty = nullptr;
  for (int probe = 0; probe < kMaxProbes && !empty; ++probe, slot = (slot + 1) & mask_) {
    const std::uint64_t there = entries_[slot].load(std::memory_order_acquire);
    if (there >> value_bits_ == q.key) return fetched(std::uint32_t(there & value_mask));
    if (there == 0) empty = &entries_[slot];
  }
  const Vec3 middle = lower_ + Vec3{float(q.cell[0]) + 0.5f, float(q.cell[1]) + 0.5f, float(q.cell[2]) + 0.5f} * cell_;
  const std::uint32_t value = search_cell(middle, q.bin, q.object);
  // Another thread may have taken the place meanwhile: then this cell is looked up again next time.
  std::uint64_t none = 0;
  if (empty) empty->compare_exchange_strong(none, q.key << value_bits_ | value, std::memory_order_release);
  return fetched(value);
}

PointLookup::Answer PointLookup::fetched(std::uint32_t value) const {
  if (value & kSeparated && value / 2) {
    const char* crowd = reinterpret_cast<const char*>(&crowds_[value / 2 - 1]);
    for (std::size_t line = 0; line < sizeof(PointCrowd); line += 64) __builtin_prefetch(crowd + line);
  } else if (value / 2) {
    __builtin_prefetch(&lights_[value / 2 - 1]);
  }
  return {value};
}

}  // namespace tempolux
