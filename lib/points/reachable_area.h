// lib/points/reachable_area.h -- the surface around a place over which the place's light can be spread, cut by walls,
// edges and steps.
#pragma once

#include <cmath>
#include <vector>

#include "lib/core/random.h"
#include "lib/density/irradiance_estimate.h"
#include "lib/irradcache/clearance.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Decides whether light that arrives at one place of a surface may count as light at another place.
class Reach {
 public:
  explicit Reach(const Tracer& tracer);

  /// Tests two ways from one place to the other: the straight line, and the path that runs in the tangent plane of
  /// `from` and then straight down to `to`. True if nothing obstructs one of the two. The straight line is obstructed
  /// where a surface bends away, the other path where a surface bends up. Both paths start and end 2 offset() above the
  /// surfaces. Normals are unit vectors on the lit sides; `to_normal` may be wrong by 1e-2.
  bool operator()(Vec3 from, Vec3 normal, Vec3 to, Vec3 to_normal) const;
  /// True if nothing obstructs the straight line between two places above surfaces.
  bool free(Vec3 from, Vec3 to) const;
  /// Unobstructed distances across the surface from a place, up to `reach` [m]. `normal`: unit, geometric, on the lit
  /// side. The spokes lie in the tangent plane of `axis`, a unit vector: the normal that Clearance::contains() will
  /// get. A surface that rises by less than 45 degrees (Clearance::kBend) does not end a spoke: the spoke follows the
  /// surface, over at most four bends.
  Clearance clearance(Vec3 position, Vec3 normal, Vec3 axis, float reach) const;
  /// m: 2^-20 of the largest coordinate of the scene.
  float offset() const { return offset_; }

 private:
  /// A ray of length `reach` along the surface with normal `up`, rising with the tangent Clearance::kOffPlane.
  Ray across(Vec3 position, Vec3 up, Vec3 outwards, float reach) const;
  float over_bends(Ray ray, Hit hit, Vec3 normal, Vec3 outwards, float reach) const;

  const Tracer& tracer_;
  float offset_;
};

/// Measures the surface that is reachable (Reach) from a place, inside an ellipsoid with the axes radius, radius and
/// radius / kFlattening (along the normal). Only surfaces within 84 degrees of the place's plane count. Thread-safe.
class ReachableArea {
 public:
  enum class Kernel { flat, round };  ///< weight of surface at distance d, in radii: 1, or 2 (1 - d^2)

  explicit ReachableArea(const Tracer& tracer);

  const Reach& reach() const { return reach_; }
  float offset() const { return reach_.offset(); }

  /// True if the disc is whole: every place on its rim is reachable across the plane and has surface. Tests sixteen
  /// places, turned by the share `turn` in [0, 1) of their distance, which miss walls that cut off less than 0.4 % of
  /// the disc. `lift` [m]: height above the plane at which the test rays end, for a normal with an error of lift /
  /// radius.
  bool whole(Vec3 position, Vec3 normal, float radius, float turn, float lift = 0) const;

  /// An estimate of 1 / reachable area [1/m^2] without bias, from random columns until `probes` of them arrive. 0 if
  /// none of 32 probes columns arrives; with the round kernel also if fewer than `probes` arrive, or none of the first
  /// quarter.
  double inverse(Vec3 position, Vec3 normal, float radius, int probes, Kernel kernel, const PathRandom& random) const;

  /// 1 / reachable area [1/m^2] of a disc, with the flat kernel. A disc that is whole(), or whose radius float
  /// positions do not resolve, counts with its whole area.
  double inverse(bool whole_disc, Vec3 position, Vec3 normal, float radius, int probes, const PathRandom& random) const;
  /// True if light at `place` counts at the centre of the disc. If the disc is whole, everything in its plane is
  /// reachable; a surface close above the plane may still be another surface.
  bool reaches(bool whole_disc, Vec3 position, Vec3 normal, Vec3 place, Vec3 place_normal) const {
    return (whole_disc && std::abs(dot(place - position, normal)) < 4 * offset()) ||
           reach_(position, normal, place, place_normal);
  }

 private:
  float column(Vec3 position, Vec3 normal, Vec3 across, float height, float u) const;

  const Tracer& tracer_;
  Reach reach_;
  std::vector<char> stores_;  ///< by material: true if it has a Lambert lobe
};

}  // namespace tempolux
