#include "lib/scene/light_units.h"

#include <algorithm>
#include <cmath>

namespace tempolux {
namespace {

/// Intensity that makes the units doubtful, cd or lux. If the exporter multiplied by 683, a lamp of 500 cd has 9.2 W in
/// Blender and a sun of 500 lux .73 W/m^2. If not, the lamp has 6.3 kW and the sun 500 W/m^2, which is unlikely.
constexpr float kDoubtful = 500;

bool is_from_blender(const std::string& generator) {
  return generator.find("Blender") != std::string::npos && generator.find("tempolux_export") == std::string::npos;
}

}  // namespace

std::string doubt_of_light_units(const Scene& scene) {
  if (!is_from_blender(scene.generator)) return "";
  float brightest = 0;
  for (const PunctualLight& light : scene.lights) brightest = std::max(brightest, max_component(light.intensity));
  if (brightest < kDoubtful) return "";
  return scene.path + ": its brightest lamp has " + std::to_string(std::lround(brightest)) +
         " cd (sun: lux): Blender's default export multiplies lamps, but not emitting surfaces, by 683; if these are, "
         "give --light-units spec "
         "(make: LIGHT_UNITS=spec; docs/from-blender.md)";
}

}  // namespace tempolux
