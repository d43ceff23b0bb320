// lib/trace/trace.h -- rays against the scene at a frame; the only user of Embree.
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
  Vec3 direction;  ///< need not be unit; t is in units of its length
  float t_min = 0, t_max = INFINITY;
  bool all_blend = false;  ///< meets surfaces of alpha mode BLEND wherever alpha > 0: to measure them, not for light
};

struct Hit {
  float t = 0;
  std::uint32_t surface = kNone, triangle = 0;  ///< index into SceneFrame::surfaces, triangle of its primitive
  float u = 0, v = 0;                           ///< barycentrics of corners 1 and 2
};

/// The search tree of what stands still, handed from the Tracer of one frame to that of the next: built anew only where
/// that is something else. For the frames of one Scene, one Tracer made at a time.
class StandingTree {
 public:
  StandingTree();
  ~StandingTree();

 private:
  friend class Tracer;
  struct Kept;
  std::shared_ptr<const Kept> kept_;
};

/// Two search trees, what is static over the segment and what moves; the nearer hit wins, static at a tie.
/// Surfaces of alpha mode MASK are not there where alpha is below the cut-off; those of BLEND are met with probability
/// alpha, drawn from the bits of ray and triangle: in the mean a share 1 - alpha of all light goes through, straight
/// on, and no one else needs to know. Thread-safe once built. Every ray is checked: one that is not finite is a miss
/// and counted, never an abort.
class Tracer {
 public:
  explicit Tracer(const SceneFrame& frame);
  /// The same; the tree of the static surfaces is that of `standing` if they are the same arrays, as in all frames of a
  /// SegmentScene, and let no ray pass by alpha. Else it is built, and left there for the next.
  Tracer(const SceneFrame& frame, StandingTree& standing);
  ~Tracer();
  Tracer(Tracer&&) noexcept;

  /// Nearest hit in (t_min, t_max). Returns false, hit untouched, if there is none.
  bool intersect(const Ray& ray, Hit& hit) const;
  /// The same for many rays, hits[i] of rays[i] (surface kNone: none): a third to a half of the time where
  /// neighbours in the list leave one place into like directions. Which of two equally near hits is reported
  /// may differ from intersect(); the same list gives the same hits.
  /// alike: false if they do not; that loses nothing against one by one.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits, bool alike = true) const;
  /// Nearest hit with the static surfaces alone.
  bool intersect_static(const Ray& ray, Hit& hit) const;
  /// Is anything in between?
  bool occluded(const Ray& ray) const;

  SurfacePoint surface_point(const Hit& hit) const;
  /// The same for many: points[i] of hits[i].
  void surface_points(std::span<const Hit> hits, SurfacePoint* points) const;
  /// Rays refused because they were not finite; for stats.
  std::uint64_t refused_ray_count() const;
  const SceneFrame& frame() const;

 private:
  struct Impl;
  void build(const SceneFrame& frame, StandingTree& standing);
  std::unique_ptr<Impl> impl_;
};

/// A ray that leaves `point` into `direction`, started off the surface on the side it leaves to.
inline Ray spawn_ray(const SurfacePoint& point, Vec3 direction) {
  const float side = std::copysign(point.offset, dot(direction, point.normal_geometric));
  return {point.position + point.normal_geometric * side, direction, 0, INFINITY};
}
/// A ray from `point` that ends just before `target`; target_offset is that point's own offset, or 0.
/// Direction is not normalised: t runs from 0 to 1.
Ray spawn_shadow_ray(const SurfacePoint& point, Vec3 target, float target_offset);

}  // namespace tempolux
