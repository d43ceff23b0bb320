// lib/scene/light_units.h -- detects lights that Blender's exporter multiplied by 683.
#pragma once

#include <string>

#include "lib/scene/scene.h"

namespace tempolux {

/// A warning if the scene's lights seem to be multiplied by 683 although they are read unchanged; else "". Blender's
/// exporter multiplies punctual lights, but not emitting surfaces, by 683 (its default lighting mode, Standard):
/// emitting surfaces are then 683 times too dark beside the lights. The warning needs a scene from Blender with a
/// light of at least 500 cd or lux: a lamp of 9.2 W in Blender is 500 cd with the factor, and .73 cd without it.
std::string doubt_of_light_units(const Scene& scene);

}  // namespace tempolux
