// lib/render/shading.h -- what the camera sees at a hit: the point turned to the viewer, its scattering.
#pragma once

#include "lib/material/bsdf.h"
#include "lib/material/seen_side.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A surface point seen along wo.
struct ShadingPoint : SeenSide {
  SurfacePoint surface;
  Bsdf bsdf;
  Bsdf::Direction eye;  ///< wo_local

  ShadingPoint(const SurfacePoint& point, Vec3 wo, const MaterialValues& material)
      : SeenSide(point, wo),
        surface(point),
        bsdf(material, dot(point.normal_geometric, wo) > 0),
        eye(bsdf.along(wo_local)) {}
};

}  // namespace tempolux
