// lib/render/shading.h -- a hit as the camera sees it: its side towards the viewer and its Bsdf.
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
