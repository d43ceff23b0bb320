// lib/gather/reachable_area.h -- the surface around a place over which the place's light can be spread, cut by walls,
// edges and steps.
#pragma once

#include <vector>

#include "lib/core/random.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/irradcache/clearance.h"
#include "lib/trace/trace.h"

namespace tempolux {

inline constexpr float kFlat = 0.005f;  ///< share of the radius: largest distance of a flat disc's rim from the plane

/// Decides whether light that falls on one place of a surface may count as light at another place.
class Reach {
 public:
  explicit Reach(const Tracer& tracer);

  /// True if nothing lies between the two places, or if nothing lies on the path across the tangent plane of `from` and
  /// from there down to `to`. The straight line fails where a surface bends away, the other path where it bends up.
  /// Both paths run 2 offset() above the surfaces. Normals are unit vectors on the lit sides; `to_normal` may be off by
  /// 1e-2.
  bool operator()(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal) const;
  /// True if nothing lies between the two places, which are above surfaces.
  bool free(Vec3 from, Vec3 to) const;
  /// Unobstructed distances across the surface from a place (normal: unit, geometric, on the lit side), along spokes in
  /// the tangent plane of `axis` (unit; the normal that Clearance::contains() will get). A surface that rises by less
  /// than 45 degrees (Clearance::kBend) does not end a spoke: the spoke follows it, over at most four bends.
  Clearance clearance(Vec3 position, Vec3 normal, Vec3 axis, float reach) const;
  /// m: 2^-20 of the largest coordinate of the scene.
  float offset() const { return offset_; }

 private:
  /// A ray along the surface whose lit side `up` points away from, rising by Clearance::kRise.
  Ray across(Vec3 position, Vec3 up, Vec3 outwards, float reach) const;
  float over_bends(Ray ray, Hit hit, Vec3 normal, Vec3 outwards, float reach) const;

  const Tracer& tracer_;
  float offset_;
};

/// Reachable surface (Reach) in the ellipsoid r : r : r / kFlattening around a place, within 84 degrees of its plane.
/// Thread-safe.
class ReachableArea {
 public:
  enum class Kernel { flat, round };  ///< weight of the surface at the share d of the radius: 1, or 2 (1 - d^2)

  explicit ReachableArea(const Tracer& tracer);

  const Reach& reach() const { return reach_; }
  float offset() const { return reach_.offset(); }

  /// True if the disc is whole: every place on its rim is reachable across the plane and has surface. Sixteen places,
  /// turned by `turn` in [0, 1), miss walls that cut off less than 0.4 % of the disc. `lift`: m above the plane at
  /// which spokes end, for normals with an error of lift / radius.
  bool whole(Vec3 position, Vec3 normal, float radius, float turn, float lift = 0) const;

  /// 1 / reachable area [1/m^2], exact in the mean. 0 if none of kMostProbes * probes columns arrives; with the round
  /// kernel also if fewer than `probes` arrive, or none of the first quarter.
  double inverse(Vec3 position, Vec3 normal, float radius, int probes, Kernel kernel, const PathRandom& random) const;

 private:
  float column(Vec3 position, Vec3 normal, Vec3 across, float height, float u) const;

  const Tracer& tracer_;
  Reach reach_;
  std::vector<char> stores_;  ///< by material: true if it has a Lambert lobe
};

}  // namespace tempolux
