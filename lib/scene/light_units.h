// lib/scene/light_units.h -- detects lights that Blender's exporter multiplied by 683.
#pragma once

#include <string>

#include "lib/scene/scene.h"

namespace tempolux {

/// A warning if the scene is from Blender and its lights are so bright that the exporter has probably multiplied them
/// by 683 (its default lighting mode, Standard), although lights are read unchanged; else "". The exporter does not
/// multiply emitting surfaces, so beside such lights they would be 683 times too dark.
/// A lamp of 9.2 W in Blender is 500 cd if it was multiplied, and .73 cd otherwise, as from
/// pipelines/blender/tempolux_export.py.
std::string doubt_of_light_units(const Scene& scene);

}  // namespace tempolux
