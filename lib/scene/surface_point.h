// lib/scene/surface_point.h -- a point on a surface of the scene at a frame.
#pragma once

#include <cstdint>

#include "lib/core/vec.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// The surface at a hit, with all that shading needs of it; scene space.
struct SurfacePoint {
  Vec3 position;          ///< m; interpolated from the triangle's corners, so it is exact to a few ulp
  Vec3 normal_geometric;  ///< unit, towards the triangle's front
  Vec3 normal;            ///< shading normal: unit, on the front side
  Vec2 uv;
  float offset = 0;  ///< m; rays that leave start this far above the side on which they leave
  std::uint32_t surface = kNone, triangle = 0, object = 0, material = 0;
  float u = 0, v = 0;  ///< barycentric coordinates of corners 1 and 2
  /// m: thickness of the plate of glass that the triangle bounds (lib/trace/plates.h). Light passes a plate straight;
  /// 0: the triangle bounds none, or the plate shall refract like other solids.
  float plate = 0;
};

}  // namespace tempolux
