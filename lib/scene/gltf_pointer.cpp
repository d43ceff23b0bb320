// lib/scene/gltf_pointer.cpp -- resolves JSON pointers of KHR_animation_pointer.
#include "lib/scene/gltf_pointer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

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
constexpr std::array kProperties{
    Property{kNodes, "/translation", Path::translation},
    Property{kNodes, "/rotation", Path::rotation},
    Property{kNodes, "/scale", Path::scale},
    Property{kNodes, "/weights", Path::weights},
    Property{kMaterials, "/pbrMetallicRoughness/baseColorFactor", Path::base_color},
    Property{kMaterials, "/pbrMetallicRoughness/metallicFactor", Path::metallic},
    Property{kMaterials, "/pbrMetallicRoughness/roughnessFactor", Path::roughness},
    Property{kMaterials, "/alphaCutoff", Path::alpha_cutoff},
    Property{kMaterials, "/emissiveFactor", Path::emissive_factor},
    Property{kMaterials, "/extensions/KHR_materials_emissive_strength/emissiveStrength", Path::emissive_strength},
    Property{kMaterials, "/extensions/KHR_materials_specular/specularFactor", Path::specular},
    Property{kMaterials, "/extensions/KHR_materials_specular/specularColorFactor", Path::specular_color},
    Property{kMaterials, "/extensions/KHR_materials_ior/ior", Path::ior},
    Property{kMaterials, "/extensions/KHR_materials_transmission/transmissionFactor", Path::transmission},
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

ColorFactors emission_of(const tinygltf::Material& source) {
  ColorFactors factors{Rgb{0.0f}, 1};
  if (source.emissiveFactor.size() >= 3)
    for (int c = 0; c < 3; ++c) factors.color[c] = float(std::max(0.0, source.emissiveFactor[std::size_t(c)]));
  const auto found = source.extensions.find("KHR_materials_emissive_strength");
  if (found != source.extensions.end() && found->second.Has("emissiveStrength"))
    factors.strength = float(std::max(0.0, found->second.Get("emissiveStrength").GetNumberAsDouble()));
  return factors;
}

ColorFactors factors_of(const tinygltf::Light& source) {
  ColorFactors factors{Rgb{1.0f}, float(std::max(0.0, source.intensity))};
  if (source.color.size() >= 3)
    for (int c = 0; c < 3; ++c) factors.color[c] = float(std::max(0.0, source.color[std::size_t(c)]));
  return factors;
}

}  // namespace

bool resolve_pointer(Import& import, const std::string& pointer, PointedAt& at) {
  for (const Property& property : kProperties) {
    if (!std::string_view(pointer).starts_with(property.array)) continue;
    const char *digits = pointer.data() + property.array.size(), *end = pointer.data() + pointer.size();
    std::size_t index = 0;
    const auto [after, error] = std::from_chars(digits, end, index);
    if (error != std::errc{} || std::string_view(after, std::size_t(end - after)) != property.rest) continue;
    if (index >= count_of(import, property.array))
      import.fail("animations", "pointer " + one_line(pointer, 100) + ": there is no such object");
    at = {property.path, int(index)};
    if (property.array == kNodes) at.target = import.node_from_source[index];
    return at.target >= 0;  // false: the node belongs to another scene of the file
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
  if (animates(Path::base_color, Path::transmission)) {
    for (const tinygltf::Material& material : import.model.materials)
      import.scene.emission_factors.push_back(emission_of(material));
    import.scene.emission_factors.resize(import.scene.materials.size());
  }
  if (animates(Path::light_color, Path::light_intensity))
    for (const tinygltf::Light& light : import.model.lights) import.scene.light_factors.push_back(factors_of(light));
}

}  // namespace tempolux::gltf
