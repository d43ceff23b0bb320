// lib/gather/gathered_record.h -- a record from a list of samples: irradiance, gradients, radii.
#pragma once

#include "lib/core/frame.h"
#include "lib/gather/hemisphere.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// m: nothing counts as nearer than this to a place; 1 / distance stays finite.
float closest_distance(const SurfacePoint& place);

/// Sets of a record what follows from one ray a cell: translational gradient. Position, normal and object are the
/// place's.
IrradianceRecord record_of_first_rays(const Hemisphere& sky, const Frame& frame, const SurfacePoint& place,
                                      Vec3 normal);

}  // namespace tempolux
