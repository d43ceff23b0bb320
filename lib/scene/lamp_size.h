// lib/scene/lamp_size.h -- the size of a punctual light, from custom properties.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.h"

namespace tempolux {

/// Reads the size of a light of this kind from the `extras` of the light or of its node, a JSON text. Empty text: 0.
/// - point and spot: `radius` or `radius_m`, m, from 0 to 1e9. It is a length in the world: glTF's properties of lights
///   do not change with the scale of nodes.
/// - directional: `angle` or `angle_rad`, rad, from 0 to pi: the angular diameter.
/// If both names are there, the first counts. Other properties are not looked at. Any other value gives 0, with a line
/// in `warnings` that begins with `place`.
LampSize read_lamp_size(const std::string& extras, PunctualLight::Kind kind, const std::string& place,
                        std::vector<std::string>& warnings);

}  // namespace tempolux
