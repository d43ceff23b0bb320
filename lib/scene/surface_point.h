// lib/scene/surface_point.h -- a point on a surface of the scene at a frame.
#pragma once

#include <cstdint>

#include "lib/core/vec.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// What a shading routine needs to know of a hit; all in scene space.
struct SurfacePoint {
  Vec3 position;          ///< from the triangle's corners, not from t: exact to a few ulp
  Vec3 normal_geometric;  ///< unit, towards the front of the triangle
  Vec3 normal;            ///< shading normal: unit, on the front's side
  Vec2 uv;
  float offset = 0;  ///< m: rays leaving start this far above the side they leave from
  std::uint32_t surface = kNone, triangle = 0, object = 0, material = 0;
  float u = 0, v = 0;
};

}  // namespace tempolux
