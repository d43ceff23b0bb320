// lib/light/closed_parts.h -- parts of an emitting surface whose inner sides cannot be seen from outside.
#pragma once

#include <vector>

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// For each triangle of the surface, the box [m, scene space] around the closed part that holds the triangle; an empty
/// box if no closed part does. A part is a set of triangles that edges join. A part is closed if it is opaque, each of
/// its edges belongs to two triangles of opposite winding, and its signed volume is positive. Seen from outside the
/// box, a closed part hides the backs of its triangles, unless it crosses itself. Exporters often make such lamps
/// two-sided, although nobody sees their backs.
std::vector<Box3> closed_parts(const SceneFrame& frame, std::uint32_t surface);

}  // namespace tempolux
