// lib/light/closed_parts.h -- parts of an emitting surface whose inner sides cannot be seen from outside.
#pragma once

#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// By triangle of the surface, the box [m, scene space] around the closed part that the triangle belongs to; an empty
/// box for other triangles. A part is all triangles that are joined by edges. The part is closed if it is opaque, each
/// of its edges belongs to two triangles of opposite winding, and its signed volume is positive. From a point outside
/// the box the part hides the backs of all its triangles; a part that crosses itself may still show some. Exporters
/// often make such lamps two-sided.
std::vector<Box3> closed_parts(const SceneFrame& frame, std::uint32_t surface);

}  // namespace tempolux
