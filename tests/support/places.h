// tests/support/places.h -- makes surface points that belong to no surface.
#pragma once

#include "lib/scene/surface_point.h"

namespace tempolux::test {

/// A surface point with this unit normal; rays start 10 um above it.
inline SurfacePoint place_at(Vec3 position, Vec3 normal) {
  SurfacePoint place;
  place.position = position;
  place.normal = place.normal_geometric = normal;
  place.offset = 1e-5f;
  return place;
}

}  // namespace tempolux::test
