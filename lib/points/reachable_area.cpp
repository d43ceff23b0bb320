#include "lib/points/reachable_area.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"

namespace tempolux {
namespace {

constexpr int kRim = Clearance::kSpokes;  ///< places on a disc's rim that are tested
constexpr float kFlat = 0.005f;           ///< largest distance of a whole disc's rim from its plane, in radii
constexpr int kMostProbes = 32;           ///< largest number of columns, in multiples of the columns that must arrive
constexpr int kMostBends = 4;             ///< bends of the surface that a spoke follows
constexpr int kMostInColumn = 8;          ///< largest number of surfaces in a column

}  // namespace

// All rays here meet surfaces of alpha mode BLEND as if the surfaces were opaque. The flux of photons already accounts
// for the light that such a surface lets pass (photon_trace.h), and the whole area of the surface counts.

Reach::Reach(const Tracer& tracer) : tracer_(tracer) {
  const Box3& bounds = tracer.frame().bounds;
  offset_ = 0x1p-20f * max_component(max(abs(bounds.lower), abs(bounds.upper)));
}

bool Reach::free(Vec3 from, Vec3 to) const { return !tracer_.occluded({from, to - from, 0, 1, true}); }

bool Reach::operator()(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal) const {
  const Vec3 start = from + normal * (2 * offset_), end = to + to_normal * (2 * offset_);
  // Both ends are above the lit sides, so a ray from behind the surface of `to` meets it just before the end.
  if (free(start, end)) return true;
  const float below = dot(from - to, normal);
  if (!(below > 0)) return false;
  const Vec3 corner = end + normal * below;
  return free(start, corner) && free(corner, end);
}

Ray Reach::across(Vec3 position, Vec3 up, Vec3 outwards, float reach) const {
  return {position + up * (2 * offset_), normalize(outwards - up * dot(outwards, up)) + up * Clearance::kOffPlane, 0,
          reach, true};
}

/// m: length of a spoke, up to `reach`. Its first ray `ray` has met `hit`. The spoke continues over bends of the
/// surface and ends at an obstacle.
float Reach::over_bends(Ray ray, Hit hit, Vec3 normal, Vec3 outwards, float reach) const {
  float gone = hit.t;
  for (int bends = 0; bends < kMostBends && gone < reach; ++bends) {
    const SurfacePoint there = tracer_.surface_point(hit);
    const Vec3 up = face_forward(there.normal_geometric, -ray.direction);
    if (!(dot(up, normal) > Clearance::kBend)) break;
    ray = across(there.position, up, outwards, reach - gone);
    if (!tracer_.intersect(ray, hit)) return reach;
    gone += hit.t;
  }
  return gone;
}

Clearance Reach::clearance(Vec3 position, Vec3 normal, Vec3 axis, float reach) const {
  const Frame frame(axis);
  std::array<Vec3, Clearance::kSpokes> outwards;
  std::array<Ray, Clearance::kSpokes> rays;
  std::array<Hit, Clearance::kSpokes> hits;
  for (std::uint32_t k = 0; k < Clearance::kSpokes; ++k) {
    const Vec2 u = Clearance::spoke(k);
    outwards[k] = frame.tangent * u.x + frame.bitangent * u.y;
    rays[k] = across(position, normal, outwards[k], reach);
  }
  tracer_.intersect(rays, hits);
  Clearance seen;
  seen.reach = reach;
  for (std::uint32_t k = 0; k < Clearance::kSpokes; ++k)
    if (hits[k].surface != kNone) seen.set(k, over_bends(rays[k], hits[k], normal, outwards[k], reach));
  return seen;
}

ReachableArea::ReachableArea(const Tracer& tracer) : tracer_(tracer), reach_(tracer) {
  for (const Material& material : tracer.frame().materials) stores_.push_back(may_have_lambert(material));
}

bool ReachableArea::whole(Vec3 position, Vec3 normal, float radius, float turn, float lift) const {
  const Frame frame(normal);
  const Vec3 start = position + normal * (2 * offset());
  const float down = 2 * offset() + lift + std::max(4 * offset(), kFlat * radius);
  for (int i = 0; i < kRim; ++i) {
    const float phi = 2 * kPi * (float(i) + turn) / float(kRim);
    const Vec3 rim = start + normal * lift + (frame.tangent * std::cos(phi) + frame.bitangent * std::sin(phi)) * radius;
    Hit hit;
    if (!reach_.free(start, rim) || !tracer_.intersect({rim, -normal, 0, down, true}, hit) ||
        !stores_[tracer_.frame().surfaces[hit.surface].material])
      return false;
  }
  return true;
}

/// Area of the reachable surface in a thin column along the normal, over the column's cross section: the sum of 1 / cos
/// of the tilts of the surfaces. The column is at the offset `across` [m] from the place and reaches from `height` [m]
/// above the plane to `height` below. With the round kernel a surface at height h counts with the probability
/// 1 - (h / height)^2, which is its kernel weight over the weight in the plane; `u` in [0, 1) decides. If the weights
/// were summed instead, they would differ between columns, and the inverse of the sum would be too large in the mean.
/// With the flat kernel u is 0.
inline float ReachableArea::column(Vec3 position, Vec3 normal, Vec3 across, float height, float u) const {
  const float half = std::max(4 * reach_.offset(), height);
  Vec3 top = position + across + normal * half;
  float left = 2 * half, sum = 0;
  for (int i = 0; i < kMostInColumn && left > 0; ++i) {
    Hit hit;
    if (!tracer_.intersect({top, -normal, 0, left, true}, hit)) break;
    const SurfacePoint there = tracer_.surface_point(hit);
    const Vec3 up = face_forward(there.normal_geometric, normal);
    const float cosine = dot(up, normal);
    const float off_plane = dot(there.position - position, normal);
    if (cosine > kMinCos && stores_[there.material] && off_plane * off_plane <= (1 - u) * half * half &&
        reach_(position, normal, there.position, up))
      sum += 1 / cosine;
    const float step = hit.t + 4 * reach_.offset();
    top = top - normal * step;
    left -= step;
  }
  return sum;
}

/// Columns are drawn over the disc until a fixed number m of them arrives at reachable surface. For independent columns
/// the mean of (number drawn) / m is exactly 1 / (share that arrives) [inverse binomial sampling, Haldane 1945]. With a
/// fixed number of columns, 1 / (share that arrived) would be biased. Stratified columns have less noise, but their
/// mean is too small by up to 1 / (2 m), because m columns arrive as soon as m - 1/2 are expected. So columns are
/// stratified for the flat kernel, and independent for the round kernel of footprints, many of which light a place. The
/// round kernel is applied by drawing columns with the density 2 (1 - d^2) / pi.
double ReachableArea::inverse(Vec3 position, Vec3 normal, float radius, int probes, Kernel kernel,
                              const PathRandom& random) const {
  const Frame frame(normal);
  const std::uint64_t key = random.bits(1, Purpose::points);
  const bool round = kernel == Kernel::round;
  int arrived = 0, drawn = 0;
  double surface = 0;  // m^2 of surface per m^2 of the disc, summed
  while (arrived < probes && drawn < kMostProbes * probes) {
    const auto i = std::uint32_t(drawn++);
    Vec2 d = sample_disc_concentric(round ? random.get2(i, Purpose::place) : sobol_owen_2d(i, key));
    if (round) {
      const float uniform = std::min(1.0f, d.x * d.x + d.y * d.y), inward = 1 / std::sqrt(1 + std::sqrt(1 - uniform));
      d = {d.x * inward, d.y * inward};  // d^2 = 1 - sqrt(1 - uniform)
    }
    const float height = radius / kFlattening * std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y));
    const float here = column(position, normal, (frame.tangent * d.x + frame.bitangent * d.y) * radius, height,
                              round ? random.get1(i, Purpose::place, 1) : 0);
    arrived += here > 0;
    surface += double(here);
    if (round && arrived == 0 && drawn >= kMostProbes * probes / 4) return 0;
  }
  if (arrived < (round ? probes : 1)) return 0;
  return double(drawn) / (double(kPi) * double(radius) * double(radius) * surface);
}

double ReachableArea::inverse(bool whole_disc, Vec3 position, Vec3 normal, float radius, int probes,
                              const PathRandom& random) const {
  return whole_disc || !(radius > 4 * offset()) ? 1 / (double(kPi) * double(radius) * double(radius))
                                                : inverse(position, normal, radius, probes, Kernel::flat, random);
}

}  // namespace tempolux
