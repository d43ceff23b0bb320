// lib/scene/light_units.h -- are the lamps of a file in candela, or 683 times as bright?
#pragma once

#include <string>

#include "lib/scene/scene.h"

namespace tempolux {

/// A warning if the scene is one of Blender's and its lamps are so bright that its exporter has probably multiplied
/// them by 683 (its default: lighting mode Standard), for scenes that are read with lights as they stand; "" if not.
/// Emitting surfaces are not multiplied, so that all of the picture but lamps would be 683 times too dark beside them.
///
/// A lamp of 9.2 W in Blender is 500 cd where it was multiplied, and .73 cd where not, as
/// pipelines/blender/tempolux_export.py leaves it.
std::string doubt_of_light_units(const Scene& scene);

}  // namespace tempolux
