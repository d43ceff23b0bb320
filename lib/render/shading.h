// lib/render/shading.h -- what the camera sees at a hit: the point turned to the viewer, its scattering.
#pragma once

#include "lib/core/frame.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A surface point seen along wo: normals on wo's side, scattering in a local frame.
struct ShadingPoint {
  SurfacePoint surface;
  Vec3 normal_geometric, normal;   ///< both on the side of wo
  Frame frame;                     ///< z = normal
  Vec3 wo_local;
  Bsdf bsdf;

  /// wo is unit and points away from the surface. Where the shading normal looks away from wo the geometric
  /// one takes its place.
  ShadingPoint(const SurfacePoint& point, Vec3 wo, const MaterialValues& material)
      : surface(point),
        normal_geometric(dot(point.normal_geometric, wo) < 0 ? -point.normal_geometric : point.normal_geometric),
        normal(viewed_normal(point, wo, normal_geometric)),
        frame(normal),
        wo_local(frame.to_local(wo)),
        bsdf(material, dot(point.normal_geometric, wo) > 0) {}

  /// Is wi on the lit side of both normals? Only then does light from it count.
  bool sees(Vec3 wi) const { return dot(wi, normal_geometric) > 0 && dot(wi, normal) > 0; }
  /// Is it beyond both of them? Then light passes through from there.
  bool sees_beyond(Vec3 wi) const { return dot(wi, normal_geometric) < 0 && dot(wi, normal) < 0; }

 private:
  static Vec3 viewed_normal(const SurfacePoint& point, Vec3 wo, Vec3 geometric) {
    const Vec3 n = dot(point.normal, geometric) < 0 ? -point.normal : point.normal;
    return dot(n, wo) > 1e-4f ? n : geometric;
  }
};

}  // namespace tempolux
