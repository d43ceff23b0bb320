// lib/gather/gathered_record.h -- computes a record from its gather rays: irradiance, gradients, radii.
#pragma once

#include "lib/core/frame.h"
#include "lib/gather/hemisphere.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// m: smallest distance from a place that is used, so that 1 / distance stays finite.
float closest_distance(const SurfacePoint& place);

/// A record with the translational gradient, which needs one ray per cell. Position, normal and object are the place's.
IrradianceRecord record_of_first_rays(const Hemisphere& sky, const Frame& frame, const SurfacePoint& place,
                                      Vec3 normal);

}  // namespace tempolux
