// lib/transport/shading.h -- a surface point with the side that a ray sees and its Bsdf.
#pragma once

#include "lib/material/bsdf.h"
#include "lib/material/seen_side.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A surface point seen from direction wo (unit, towards the viewer). point: with the material's normal map applied.
struct ShadingPoint : SeenSide {
  SurfacePoint surface;
  Bsdf bsdf;
  Bsdf::Direction eye;  ///< wo_local, with what the Bsdf needs of it

  ShadingPoint(const SurfacePoint& point, Vec3 wo, const MaterialValues& material)
      : SeenSide(point, wo),
        surface(point),
        bsdf(material, dot(point.normal_geometric, wo) > 0),
        eye(bsdf.along(wo_local)) {}
};

}  // namespace tempolux
