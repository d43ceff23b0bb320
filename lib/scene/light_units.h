// lib/scene/light_units.h -- detects lights that Blender's exporter multiplied by 683.
#pragma once

#include <string>

#include "lib/scene/scene.h"

namespace tempolux {

/// A warning if the scene's lights seem to be multiplied by 683 although they are read unchanged; else "". In its
/// default lighting mode, Standard, Blender's exporter multiplies punctual lights by 683, but not emitting surfaces,
/// which are then 683 times too dark relative to the lights. The warning appears for a scene from Blender with a light
/// of at least 500 cd or lux.
std::string doubt_of_light_units(const Scene& scene);

}  // namespace tempolux
