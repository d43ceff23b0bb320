// lib/gather/gathered_record.h -- computes a record from its gather rays: irradiance and gradients.
#pragma once

#include "lib/gather/hemisphere.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// m: smallest distance from a place that is used, so that 1 / distance stays finite.
float closest_distance(const SurfacePoint& place);

/// The record of a place from its hemisphere: irradiance and gradients, without radii.
IrradianceRecord gathered_record(const Hemisphere& sky, const SurfacePoint& place, Vec3 normal);

}  // namespace tempolux
