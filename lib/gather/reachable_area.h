// lib/gather/reachable_area.h -- what of the surface around a place its light can be spread over: walls, edges, steps.
#pragma once

#include <vector>

#include "lib/core/random.h"
#include "lib/irradcache/clearance.h"
#include "lib/trace/trace.h"

namespace tempolux {

inline constexpr float kFlattening = 10;  ///< of the ellipsoid about a place, along its normal
inline constexpr float kFlat = 0.005f;    ///< of the radius: how far off the plane the rim of a flat disc may lie
inline constexpr float kMinCos = 0.1f;    ///< of its normal and those of surfaces that count

/// Can light that falls on one place of a surface be taken for light at another near it?
class Reach {
 public:
  explicit Reach(const Tracer& tracer);

  /// Either nothing is between the two, or nothing is on the way across the tangent plane of `from` and down
  /// from there: the straight line cuts through a surface that bends away, the other way through one that
  /// bends up. Both ways run a little (2 offset()) above the surfaces, whose normals are
  /// unit and on the lit sides; that of `to` may be off by 1e-2.
  bool operator()(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal) const;
  /// Is nothing between the two, which lie above surfaces?
  bool free(Vec3 from, Vec3 to) const;
  /// What is seen across the surface from a place (normal: unit, geometric, on the lit side), along spokes of the
  /// tangent plane of `axis` (unit; the normal that Clearance::contains() will be given). A surface that faces the
  /// place at less than 45 degrees (Clearance::kBend) does not end a spoke: it goes on along that, over four bends at
  /// most.
  Clearance clearance(Vec3 position, Vec3 normal, Vec3 axis, float reach) const;
  /// m: 2^-20 of the largest coordinate of the scene.
  float offset() const { return offset_; }

 private:
  /// A ray over the surface whose lit side `up` points away from, rising by Clearance::kRise.
  Ray across(Vec3 position, Vec3 up, Vec3 outwards, float reach) const;
  float over_bends(Ray ray, Hit hit, Vec3 normal, Vec3 outwards, float reach) const;

  const Tracer& tracer_;
  float offset_;
};

/// Surface in the ellipsoid r : r : r / kFlattening about a place that can be reached from it (Reach), within 84
/// degrees of its plane. Thread-safe.
class ReachableArea {
 public:
  enum class Kernel { flat, round };  ///< how it is weighted: 1, or 2 (1 - d^2) at the share d of the radius

  explicit ReachableArea(const Tracer& tracer);

  const Reach& reach() const { return reach_; }
  float offset() const { return reach_.offset(); }

  /// Is the disc whole: can every place on its rim be reached across the plane, and is surface there? Sixteen places,
  /// turned by `turn` of [0, 1), miss walls that cut off less than 0.4 % of the disc. `lift`: m above the plane that
  /// spokes end, for normals that are known to lift / radius only.
  bool whole(Vec3 position, Vec3 normal, float radius, float turn, float lift = 0) const;
  /// One of those places.
  bool whole_towards(Vec3 position, Vec3 normal, Vec3 outwards, float radius, float lift) const;

  /// 1 / area that can be reached, 1/m^2, exact in the mean; 0 if of kMostProbes * probes drawn columns none
  /// arrives, with the round kernel if fewer than `probes` do, or none of the first quarter.
  double inverse(Vec3 position, Vec3 normal, float radius, int probes, Kernel kernel, const PathRandom& random) const;

 private:
  /// Where rays along a disc begin, and how far they look down from its rim.
  Vec3 start_of(Vec3 position, Vec3 normal) const { return position + normal * (2 * offset()); }
  float depth_of(float radius, float lift) const {
    return 2 * offset() + lift + std::max(4 * offset(), kFlat * radius);
  }
  bool whole_from(Vec3 start, Vec3 normal, Vec3 outwards, float radius, float lift, float down) const;
  float column(Vec3 position, Vec3 normal, Vec3 across, float height, float u) const;

  const Tracer& tracer_;
  Reach reach_;
  std::vector<char> stores_;  ///< by material: has a Lambert lobe
};

}  // namespace tempolux
