// lib/trace/trace.h -- intersects rays with the scene at a frame; the only user of Embree.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// The points origin + t direction with t_min < t < t_max.
struct Ray {
  Vec3 origin;     ///< scene space, m
  Vec3 direction;  ///< need not be unit
  float t_min = 0, t_max = INFINITY;
  bool all_blend = false;  ///< hits surfaces of alpha mode BLEND wherever alpha > 0: for measurements, not for light
};

/// Where a ray meets a surface.
struct Hit {
  float t = 0;
  std::uint32_t surface = kNone, triangle = 0;  ///< index into SceneFrame::surfaces; triangle of its primitive
  float u = 0, v = 0;                           ///< barycentric coordinates of corners 1 and 2
};

/// Passes the search tree of the static surfaces from one frame's Tracer to the next frame's, which builds a new tree
/// only if the static surfaces differ. For frames of one Scene; only one Tracer may be constructed with it at a time.
class StaticTree {
 public:
  StaticTree();
  ~StaticTree();

 private:
  friend class Tracer;
  struct Kept;
  struct Plates;
  std::shared_ptr<const Kept> kept_;
  std::shared_ptr<const Plates> plates_;
};

/// Finds the closest hit of a ray. There are two search trees: static surfaces, and surfaces that move in the segment;
/// at equal distance the static surface is hit.
/// Surfaces of alpha mode MASK have holes where alpha is below the cut-off. A surface of mode BLEND is hit with
/// probability alpha, decided by a hash of ray and triangle. So on average a share 1 - alpha of all light passes
/// straight through, and callers need not handle alpha. Thread-safe after construction. A ray that is not finite, or
/// longer than 1e18 m, counts as a miss; refused_ray_count() counts such rays.
class Tracer {
 public:
  /// Builds both trees. The frame must outlive the Tracer. Throws ResourceError if memory is short.
  explicit Tracer(const SceneFrame& frame);
  /// Takes the static tree from `static_scene` if its surfaces are the same arrays as the frame's (as in all frames of
  /// a SegmentScene). Otherwise builds the tree and stores it there for the next frame.
  Tracer(const SceneFrame& frame, StaticTree& static_scene);
  ~Tracer();
  Tracer(Tracer&&) noexcept;

  /// Closest hit in (t_min, t_max). False, with `hit` unchanged, if there is none.
  bool intersect(const Ray& ray, Hit& hit) const;
  /// hits[i] is the hit of rays[i], with surface kNone if there is none. The result is the same as for one ray at a
  /// time, even where two surfaces coincide, so that such a surface does not look dark to pixels and bright to gather
  /// rays.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// True if a surface lies between the ray's ends, or the ray is not finite. Panes are surfaces, too; the light that
  /// passes them is transmittance().
  bool occluded(const Ray& ray) const;

  /// The point of a hit of this frame.
  SurfacePoint surface_point(const Hit& hit) const;
  /// points[i] is the point of hits[i].
  void surface_points(std::span<const Hit> hits, SurfacePoint* points) const;
  /// Number of rays that were refused because they were not finite.
  std::uint64_t refused_ray_count() const;
  const SceneFrame& frame() const;
  /// True if light may go straight through some surface: a pane (may_be_pane) or a plate (plates.h).
  bool has_panes() const;
  /// True if light may go straight through the surface at a hit.
  bool may_pass(const Hit& hit) const;
  /// True if the whole surface consists of plates.
  bool is_plate(std::uint32_t surface) const;

 private:
  struct Impl;
  void build(const SceneFrame& frame, StaticTree& static_scene);
  std::unique_ptr<Impl> impl_;
};

/// A ray from `point` along `direction` that starts at the point's offset from the surface, on the side of `direction`.
inline Ray spawn_ray(const SurfacePoint& point, Vec3 direction) {
  const float side = std::copysign(point.offset, dot(direction, point.normal_geometric));
  return {point.position + point.normal_geometric * side, direction, 0, INFINITY};
}
/// Moves the start of a ray behind the surface that the ray meets at `t` in `point`. Origin and direction do not
/// change, so that alpha decides as before.
inline void pass_surface(const SurfacePoint& point, float t, Ray& ray) {
  ray.t_min = t + point.offset / std::abs(dot(point.normal_geometric, ray.direction));
}
/// A ray from `point` to just before `target` (scene space), with t from 0 to 1. `target_offset` [m] is the offset of
/// the target's surface; 0 if there is no surface.
Ray spawn_shadow_ray(const SurfacePoint& point, Vec3 target, float target_offset);

/// Narrows [first, last] to the part of a ray inside a box; false if nothing remains. `inverse` is 1 / direction; the
/// origin lies anywhere between `below` and `above`. A ray in the plane of a face gives 0 x infinity = NaN, which
/// std::min and std::max ignore as second argument.
inline bool meets_slabs(const Box3& box, Vec3 below, Vec3 above, Vec3 inverse, float first, float last) {
  for (int axis = 0; axis < 3; ++axis) {
    const float a = (box.lower[axis] - above[axis]) * inverse[axis],
                b = (box.upper[axis] - below[axis]) * inverse[axis];
    first = std::max(first, inverse[axis] < 0 ? b : a);
    last = std::min(last, inverse[axis] < 0 ? a : b);
  }
  return first <= last;
}

}  // namespace tempolux
