// lib/material/seen_side.h -- a surface point whose normals are turned to the side from which it is seen.
#pragma once

#include "lib/material/shading_frame.h"
#include "lib/scene/surface_point.h"

namespace tempolux {

/// A shading normal faces a direction if their cosine is above this.
inline constexpr float kLooksAway = 1e-4f;
/// Shading normals whose cosine to the geometric normal is below this (half a degree) need shading of their own.
inline constexpr float kBent = 0.99996f;

/// The normal n, turned to the side of `towards`.
inline Vec3 face_forward(Vec3 n, Vec3 towards) { return dot(n, towards) < 0 ? -n : n; }

/// The normals of a point, turned to the side of wo (unit, away from the surface), and wo in the local frame of the
/// Bsdf. If the shading normal does not face wo, the geometric normal replaces it.
struct SeenSide {
  Vec3 normal_geometric, normal;
  ShadingFrame frame;  ///< z = normal
  Vec3 wo_local;

  SeenSide(const SurfacePoint& point, Vec3 wo)
      : normal_geometric(face_forward(point.normal_geometric, wo)),
        normal(viewed_normal(point, wo, normal_geometric)),
        frame(normal, normal_geometric),
        wo_local(frame.to_local(wo)) {}

  /// A normal n of the surface, turned to the side of wo.
  Vec3 facing(Vec3 n) const { return face_forward(n, normal_geometric); }

  /// True if wi is on wo's side of the surface, by both normals. Only light from there can be reflected. That holds for
  /// light that a lobe sends to an image (ShadingFrame) as well: the image of a direction in the lobe is on that side.
  bool sees(Vec3 wi) const { return dot(wi, normal_geometric) > 0 && dot(wi, normal) > 0; }
  /// True if wi is on the other side, by both normals. Only light from there can be transmitted.
  bool sees_behind(Vec3 wi) const { return dot(wi, normal_geometric) < 0 && dot(wi, normal) < 0; }

 private:
  static Vec3 viewed_normal(const SurfacePoint& point, Vec3 wo, Vec3 geometric) {
    const Vec3 n = face_forward(point.normal, geometric);
    return dot(n, wo) > kLooksAway ? n : geometric;
  }
};

}  // namespace tempolux
