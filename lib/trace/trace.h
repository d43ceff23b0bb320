// lib/trace/trace.h -- intersects rays with the scene at a frame; the only user of Embree.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

struct Ray {
  Vec3 origin;     ///< scene space
  Vec3 direction;  ///< need not be unit; t is in multiples of its length
  float t_min = 0, t_max = INFINITY;
  bool all_blend = false;  ///< hits surfaces of alpha mode BLEND wherever alpha > 0: for measurements, not for light
};

struct Hit {
  float t = 0;
  std::uint32_t surface = kNone, triangle = 0;  ///< index into SceneFrame::surfaces; triangle of its primitive
  float u = 0, v = 0;                           ///< barycentric coordinates of corners 1 and 2
};

/// The search tree of the static surfaces, passed from one frame's Tracer to the next one's; built anew only if the
/// static surfaces differ. For frames of one Scene; only one Tracer may be constructed at a time.
class StaticTree {
 public:
  StaticTree();
  ~StaticTree();

 private:
  friend class Tracer;
  struct Kept;
  std::shared_ptr<const Kept> kept_;
};

/// Finds the nearest hit of a ray. There are two search trees: static surfaces, and surfaces that move in the
/// segment; at equal distance the static surface is hit.
/// Surfaces of alpha mode MASK have holes where alpha is below the cut-off. A surface of mode BLEND is hit with
/// probability alpha, decided by a hash of ray and triangle: on average a share 1 - alpha of all light passes
/// straight through, and callers need not handle alpha.
/// Thread-safe once built. A ray that is not finite counts as a miss; refused_ray_count() counts such rays.
class Tracer {
 public:
  explicit Tracer(const SceneFrame& frame);
  /// The same with the tree in `static_scene`, if its static surfaces are the same arrays (as in all frames of a
  /// SegmentScene) and none lets rays pass by alpha. Otherwise the tree is built and left in `static_scene` for the
  /// next frame.
  Tracer(const SceneFrame& frame, StaticTree& static_scene);
  ~Tracer();
  Tracer(Tracer&&) noexcept;

  /// Nearest hit in (t_min, t_max). False, with `hit` unchanged, if there is none.
  bool intersect(const Ray& ray, Hit& hit) const;
  /// The same for many rays: hits[i] belongs to rays[i] (surface kNone: no hit), and is what rays[i] alone meets, also
  /// where two surfaces coincide: such a surface may not look dark to pixels and bright to gather rays.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// True if a surface lies between the ray's ends. Panes are surfaces, too: for light call transmittance().
  bool occluded(const Ray& ray) const;

  SurfacePoint surface_point(const Hit& hit) const;
  /// The same for many: points[i] belongs to hits[i].
  void surface_points(std::span<const Hit> hits, SurfacePoint* points) const;
  /// Number of rays refused because they were not finite; for stats.
  std::uint64_t refused_ray_count() const;
  const SceneFrame& frame() const;
  /// True if light may go straight through some surface (may_be_pane).
  bool has_panes() const;

 private:
  struct Impl;
  void build(const SceneFrame& frame, StaticTree& static_scene);
  std::unique_ptr<Impl> impl_;
};

/// A ray from `point` into `direction` that starts off the surface, on the side it leaves to.
inline Ray spawn_ray(const SurfacePoint& point, Vec3 direction) {
  const float side = std::copysign(point.offset, dot(direction, point.normal_geometric));
  return {point.position + point.normal_geometric * side, direction, 0, INFINITY};
}
/// Moves the start of a ray behind the surface that the ray meets at `t` in `point`. Origin and direction stay, so that
/// alpha decides as before.
inline void pass_surface(const SurfacePoint& point, float t, Ray& ray) {
  ray.t_min = t + point.offset / std::abs(dot(point.normal_geometric, ray.direction));
}
/// A ray from `point` that ends just before `target`; target_offset is the target's own offset, or 0. The direction is
/// not normalised: t runs from 0 to 1.
Ray spawn_shadow_ray(const SurfacePoint& point, Vec3 target, float target_offset);

}  // namespace tempolux
