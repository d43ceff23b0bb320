// lib/scene/gltf_pointer.cpp -- resolves JSON pointers of KHR_animation_pointer.
#include "lib/scene/gltf_pointer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>

#include "lib/scene/material_properties.h"

namespace tempolux::gltf {
namespace {

using Path = AnimationTrack::Path;

/// A property of the elements of an array of the document.
struct Property {
  std::string_view array, rest;
  Path path;
};

constexpr std::string_view kNodes = "/nodes/", kMaterials = "/materials/", kCameras = "/cameras/",
                           kLights = "/extensions/KHR_lights_punctual/lights/";
constexpr std::array kProperties{Property{kNodes, "/translation", Path::translation},
                                 Property{kNodes, "/rotation", Path::rotation},
                                 Property{kNodes, "/scale", Path::scale},
                                 Property{kNodes, "/weights", Path::weights},
                                 Property{kNodes, "/extensions/KHR_node_visibility/visible", Path::visible},
                                 Property{kLights, "/color", Path::light_color},
                                 Property{kLights, "/intensity", Path::light_intensity},
                                 Property{kLights, "/spot/innerConeAngle", Path::inner_cone},
                                 Property{kLights, "/spot/outerConeAngle", Path::outer_cone},
                                 Property{kCameras, "/perspective/yfov", Path::yfov},
                                 Property{kCameras, "/orthographic/ymag", Path::ymag}};

std::size_t count_of(const Import& import, std::string_view array) {
  return array == kNodes       ? import.model.nodes.size()
         : array == kMaterials ? import.model.materials.size()
         : array == kLights    ? import.model.lights.size()
                               : import.model.cameras.size();
}

ColorFactors factors_of(const tinygltf::Light& source) {
  ColorFactors factors{Rgb{1.0f}, float(std::max(0.0, source.intensity))};
  if (source.color.size() >= 3)
    for (int c = 0; c < 3; ++c) factors.color[c] = float(std::max(0.0, source.color[std::size_t(c)]));
  return factors;
}

}  // namespace

bool resolve_pointer(Import& import, const std::string& pointer, PointedAt& at) {
  // The index of the object if the pointer names this property of an object of `array`.
  const auto index_of = [&](std::string_view array, std::string_view property) -> std::optional<std::size_t> {
    if (!std::string_view(pointer).starts_with(array)) return std::nullopt;
    const char *digits = pointer.data() + array.size(), *end = pointer.data() + pointer.size();
    std::size_t index = 0;
    const auto [after, error] = std::from_chars(digits, end, index);
    if (error != std::errc{} || std::string_view(after, std::size_t(end - after)) != property) return std::nullopt;
    if (index >= count_of(import, array))
      import.fail("animations", "pointer " + one_line(pointer, 100) + ": there is no such object");
    return index;
  };
  for (const Property& property : kProperties)
    if (const auto index = index_of(property.array, property.rest)) {
      at = {property.path, int(*index)};
      if (property.array == kNodes) at.target = import.node_from_source[*index];
      return at.target >= 0;  // false: the node belongs to another scene of the file
    }
  for (std::size_t row = 0; row < material_properties().size(); ++row)
    if (const MaterialProperty& property = material_properties()[row]; property.animated())
      if (const auto index = index_of(kMaterials, property.pointer)) {
        at = {Path::material, int(*index), row};
        return true;
      }
  import.ignore("animation of " + (pointer.empty() ? "a pointer that is not said" : one_line(pointer, 100)));
  return false;
}

void keep_factors(Import& import) {
  const auto animates = [&](Path first, Path last) {
    for (const Animation& animation : import.scene.animations)
      for (const AnimationTrack& track : animation.tracks)
        if (track.path >= first && track.path <= last) return true;
    return false;
  };
  if (animates(Path::material, Path::material)) import.scene.emission_factors = import.emission_factors;
  if (animates(Path::light_color, Path::light_intensity))
    for (const tinygltf::Light& light : import.model.lights) import.scene.light_factors.push_back(factors_of(light));
}

}  // namespace tempolux::gltf
