// lib/material/seen_side.h -- a surface point turned to where it is looked at from.
#pragma once

#include "lib/core/frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// Cosine below which a shading normal looks away from a direction.
inline constexpr float kLooksAway = 1e-4f;

/// Normals on the side of wo (unit, away from the surface) and wo in the frame in which the material scatters. Where
/// the shading normal looks away from wo the geometric one takes its place.
struct SeenSide {
  Vec3 normal_geometric, normal;
  Frame frame;  ///< z = normal
  Vec3 wo_local;

  SeenSide(const SurfacePoint& point, Vec3 wo)
      : normal_geometric(dot(point.normal_geometric, wo) < 0 ? -point.normal_geometric : point.normal_geometric),
        normal(viewed_normal(point, wo, normal_geometric)),
        frame(normal),
        wo_local(frame.to_local(wo)) {}

  /// A normal of the surface, turned to the side that is seen.
  Vec3 facing(Vec3 n) const { return dot(n, normal_geometric) < 0 ? -n : n; }

  /// Is wi on the lit side of both normals? Only then does light from it count.
  bool sees(Vec3 wi) const { return dot(wi, normal_geometric) > 0 && dot(wi, normal) > 0; }
  /// Is it beyond both of them? Then light passes through from there.
  bool sees_beyond(Vec3 wi) const { return dot(wi, normal_geometric) < 0 && dot(wi, normal) < 0; }

 private:
  static Vec3 viewed_normal(const SurfacePoint& point, Vec3 wo, Vec3 geometric) {
    const Vec3 n = dot(point.normal, geometric) < 0 ? -point.normal : point.normal;
    return dot(n, wo) > kLooksAway ? n : geometric;
  }
};

}  // namespace tempolux
