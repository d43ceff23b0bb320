#include "lib/points/footprint_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/core/frame.h"
#include "lib/core/parallel_each.h"
#include "lib/core/sampling.h"
#include "lib/density/path_signs.h"
#include "lib/density/photon_reach.h"
#include "lib/material/seen_side.h"

namespace tempolux {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kThin =
    64;  ///< smallest radius of an ellipsoid whose height float positions resolve, over Reach::offset()
constexpr float kLift = 1e-4f;    ///< largest error of height from the rounding of stored normals, over the distance
constexpr int kMostHalvings = 6;  ///< of a footprint's radius, if hardly any of the footprint is surface
constexpr std::size_t kLeavesAtOnce = 16;  ///< leaves that a thread takes together
/// Probes that must arrive if a footprint is not a whole disc. The area then has a relative error of 1 / sqrt(16). Many
/// footprints light a place, so the errors average, and their mean is small compared with the noise of the photons.
constexpr int kAreaProbes = 16;

}  // namespace

float received_share(Vec3 wi, Vec3 normal, const LitSurface& at) {
  const Vec3 axis = cross(normal, at.smooth), once = cross(axis, wi);
  const Vec3 turned = wi + once + cross(axis, once) * (1 / std::max(kMinCos, 1 + dot(normal, at.smooth)));  // Rodrigues
  const float cosine = dot(turned, at.shading);
  if (!(cosine > 0)) return 0;
  return cosine / std::max(kLooksAway, dot(wi, normal)) * (at.bsdf ? at.bsdf->arrival_weight(turned, at.shading) : 1);
}

FootprintDensity::FootprintDensity(const Tracer& tracer, const PhotonView& photons, const FootprintOptions& options,
                                   std::uint8_t kinds, Vec3d shift)
    : options_(options), area_(tracer), index_(photons.photons, kinds, shift) {
  if (empty()) return;
  signs_ = path_signs(photons.photons, index_);
  directed_ = photons.directed();
  if (directed_) arriving_from_.resize(index_.size());
  if (!(options_.max_radius > 0)) options_.max_radius = photon_reach(index_, options.neighbours);
  const std::size_t leaves = (index_.size() + kLeaf - 1) / kLeaf;
  leaves_ = std::make_unique<Leaf[]>(leaves);
  extents_ = std::make_unique<std::atomic<Extent>[]>(index_.size());
  parallel_each(leaves * kLeaf, kLeavesAtOnce * kLeaf, [&](std::size_t i) {
    thread_local NeighbourList found;
    Leaf& leaf = leaves_[i / kLeaf];
    const std::size_t lane = i % kLeaf;
    if (i >= index_.size()) {
      leaf.x[lane] = kNaN;
      return;
    }
    const Vec3 position = index_.position(i);
    const Vec3 n = vec_of(formats::decode_normal(photons.photons[index_.source(i)].normal));
    const float radius = radius_of(i, n, found);
    leaf.x[lane] = position.x, leaf.y[lane] = position.y, leaf.z[lane] = position.z;
    leaf.nx[lane] = n.x, leaf.ny[lane] = n.y, leaf.nz[lane] = n.z;
    leaf.inverse_r2[lane] = 1 / (radius * radius);
    if (directed_) arriving_from_[i] = *photons.direction(index_.source(i));
    const float flattening = radius / std::max(radius / kFlattening, kThin / kFlattening * area_.offset());
    leaf.flat[lane] = flattening * flattening - 1;
  });
  build_tree();
}

/// r_i [m] before it is halved.
float FootprintDensity::radius_of(std::size_t photon, Vec3 normal, NeighbourList& found) const {
  const int wanted = std::min(options_.neighbours + 1, kMaxNeighbours);  // one more, since the photon finds itself
  index_.find_nearest({index_.position(photon), normal, options_.max_radius, kMinCos, kFlattening}, wanted, found);
  const float radius =
      int(found.count()) < wanted ? options_.max_radius : std::sqrt(found.distance2()[found.farthest()]);
  return std::max(std::min(radius, options_.max_radius), area_.offset());
}

/// Builds the tree over the boxes of all footprints.
void FootprintDensity::build_tree() {
  const std::size_t leaves = (index_.size() + kLeaf - 1) / kLeaf;
  std::vector<Box3> boxes(leaves);
  parallel_each(index_.size(), kLeavesAtOnce * kLeaf, [&](std::size_t i) {
    const Leaf& leaf = leaves_[i / kLeaf];
    const std::size_t lane = i % kLeaf;
    const float radius = outer_radius(std::uint32_t(i));
    const auto half = [&](float n) {  // half extent of the ellipsoid's box
      return radius * std::sqrt(std::max(0.0f, 1 - n * n + n * n / (leaf.flat[lane] + 1))) * 1.0001f + area_.offset();
    };
    const Vec3 middle = index_.position(i), halves{half(leaf.nx[lane]), half(leaf.ny[lane]), half(leaf.nz[lane])};
    boxes[i / kLeaf].add(middle - halves);
    boxes[i / kLeaf].add(middle + halves);
  });
  tree_ = BoxTree(std::move(boxes));
}

/// Finds the footprints that cover a position, before they are halved.
void FootprintDensity::find_covering(Vec3 position, Vec3 normal, std::vector<Covering>& found) const {
  struct Entry {
    std::size_t level, node;
  };
  constexpr std::size_t kChildren = BoxTree::kChildren;
  std::array<Entry, (kChildren - 1) * 12 + 1> stack;  // 2^31 photons need 9 levels
  std::size_t depth = 0;
  stack[depth++] = {tree_.level_count() - 1, 0};
  while (depth > 0) {
    const auto [level, number] = stack[--depth];
    const BoxTree::Node& node = tree_.node(level, number);
    std::array<int, kChildren> inside;
    for (std::size_t c = 0; c < kChildren; ++c)  // a missing child holds NaN and is never inside
      inside[c] = (position.x >= node.lower[0][c]) & (position.x <= node.upper[0][c]) &
                  (position.y >= node.lower[1][c]) & (position.y <= node.upper[1][c]) &
                  (position.z >= node.lower[2][c]) & (position.z <= node.upper[2][c]);
    for (std::size_t c = 0; c < kChildren; ++c) {
      if (!inside[c]) continue;
      if (level == 0) scan_leaf(kChildren * number + c, position, normal, found);
      else stack[depth++] = {level - 1, kChildren * number + c};
    }
  }
}

void FootprintDensity::scan_leaf(std::size_t number, Vec3 position, Vec3 normal, std::vector<Covering>& found) const {
  const Leaf& leaf = leaves_[number];
  std::array<float, kLeaf> distance2;
  std::array<int, kLeaf> covers;
  int any = 0;
  for (std::size_t i = 0; i < kLeaf; ++i) {
    const float dx = position.x - leaf.x[i], dy = position.y - leaf.y[i], dz = position.z - leaf.z[i];
    const float h = dx * leaf.nx[i] + dy * leaf.ny[i] + dz * leaf.nz[i];
    distance2[i] = dx * dx + dy * dy + dz * dz + leaf.flat[i] * h * h;
    const float cosine = normal.x * leaf.nx[i] + normal.y * leaf.ny[i] + normal.z * leaf.nz[i];
    covers[i] = (distance2[i] * leaf.inverse_r2[i] < 1) & (cosine > kMinCos);
    any |= covers[i];
  }
  for (std::size_t i = 0; i < kLeaf && any; ++i)
    if (covers[i]) found.push_back({std::uint32_t(number * kLeaf + i), distance2[i]});
}

float FootprintDensity::outer_radius(std::uint32_t photon) const {
  return 1 / std::sqrt(leaves_[photon / kLeaf].inverse_r2[photon % kLeaf]);
}

Vec3 FootprintDensity::normal_of(std::uint32_t photon) const {
  const Leaf& leaf = leaves_[photon / kLeaf];
  const std::size_t lane = photon % kLeaf;
  return {leaf.nx[lane], leaf.ny[lane], leaf.nz[lane]};
}

/// The extent of a footprint. The first thread that needs it measures it; another thread that needs it at the same time
/// computes the same value.
FootprintDensity::Extent FootprintDensity::extent_of(std::uint32_t photon) const {
  std::atomic<Extent>& known = extents_[photon];
  Extent extent = known.load(std::memory_order_relaxed);
  if (!extent.known()) {
    extent = measure(photon);
    known.store(extent, std::memory_order_relaxed);
  }
  return extent;
}

/// Measures the extent of a footprint. Halves its radius while it is mostly empty, as around a photon on a wire.
FootprintDensity::Extent FootprintDensity::measure(std::uint32_t photon) const {
  const Vec3 position = index_.position(photon), normal = normal_of(photon);
  const PathRandom random(0x666f6f74ull, index_.source(photon));
  float radius = outer_radius(photon);
  if (radius < kThin * area_.offset() ||
      area_.whole(position, normal, radius, random.get1(2, Purpose::points), kLift * radius))
    return Extent::of_whole_disc(radius);
  for (int i = 0; i <= kMostHalvings; ++i, radius /= 2) {
    const PathRandom draws(random.bits(std::uint32_t(i), Purpose::points, 1), 0);
    const double inverse = area_.inverse(position, normal, radius, kAreaProbes, ReachableArea::Kernel::round, draws);
    if (inverse > 0) return Extent::of_area(radius, float(inverse));
  }
  return Extent::of_area(2 * radius, 1 / (kPi * 4 * radius * radius));
}

/// A photon that lights a place if the place is reachable from it.
struct FootprintDensity::Candidate {
  std::uint32_t photon;
  Rgbd irradiance;    ///< W/m^2
  double importance;  ///< >= 0: sum of the channels' magnitudes
};

struct FootprintDensity::Sums {
  Rgbd irradiance{0.0}, noise{0.0};  ///< W/m^2
  void add(const Rgbd& light, int sign) {
    irradiance += light;
    noise += light * double(sign);
  }
};

/// Light of the candidates from which a place is reachable, estimated from options_.asked of them. They are drawn in
/// proportion to their importance, by equal steps along the running sum of importance, whose total is `whole`.
FootprintDensity::Sums FootprintDensity::of_asked(Vec3 position, Vec3 normal, std::span<const Candidate> candidates,
                                                  double whole) const {
  const auto reaches = [&](std::uint32_t photon) {
    return area_.reach()(index_.position(photon), normal_of(photon), position, normal);
  };
  Sums sums;
  if (options_.asked == 0 || candidates.size() <= std::size_t(options_.asked)) {
    for (const Candidate& c : candidates)
      if (reaches(c.photon)) sums.add(c.irradiance, signs_[c.photon]);
    return sums;
  }
  const double step = whole / options_.asked;
  double next = step * double(PathRandom(0x61736b6564ull, place_key(position, normal, 0)).get1(0, Purpose::points)),
         passed = 0;
  for (const Candidate& c : candidates) {
    int times = 0;
    for (passed += c.importance; next < passed; next += step) ++times;
    if (times > 0 && reaches(c.photon)) sums.add(c.irradiance * (times * step / c.importance), signs_[c.photon]);
  }
  return sums;
}

FootprintLight FootprintDensity::estimate(Vec3 position, const LitSurface& surface) const {
  const Vec3 normal = surface.geometric;
  if (empty()) return {};
  thread_local std::vector<Covering> covering;
  covering.clear();
  find_covering(position, normal, covering);
  thread_local std::vector<Candidate> candidates;
  candidates.clear();
  Sums sums;
  double whole = 0;
  float inside = 0;  // m: largest distance between the place and the border of a footprint that covers the place
  for (const auto [photon, distance2] : covering) {
    const Extent extent = extent_of(photon);
    const float radius = extent.radius();
    inside = std::max(inside, radius - std::sqrt(distance2));
    double weight = 2 * (1 - double(distance2) / (double(radius) * double(radius)));
    if (!(weight > 0)) continue;  // the footprint was made smaller
    if (directed_) weight *= double(received_share(arriving_from_[photon], normal_of(photon), surface));
    if (!(weight > 0)) continue;
    const Vec3 from = index_.position(photon), from_normal = normal_of(photon);
    const bool in_plane =
        extent.whole_disc() && std::abs(dot(position - from, from_normal)) < 4 * area_.offset() + kLift * radius;
    const Rgbd irradiance = Rgbd(index_.flux(photon)) * (weight * double(extent.inverse_area()));
    if (in_plane) {
      sums.add(irradiance, signs_[photon]);
      continue;
    }
    const double importance = std::abs(irradiance.r) + std::abs(irradiance.g) + std::abs(irradiance.b);
    candidates.push_back({photon, irradiance, importance});
    whole += importance;
  }
  if (!candidates.empty()) {
    const Sums asked = of_asked(position, normal, candidates, whole);
    sums.irradiance += asked.irradiance, sums.noise += asked.noise;
  }
  return {Rgb(sums.irradiance), Rgb(sums.noise), inside / 9};
}

}  // namespace tempolux
