// lib/scene/gltf_material.cpp -- reads materials, punctual lights and cameras.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {
namespace {

using tinygltf::Value;

constexpr double kNoUpper = std::numeric_limits<float>::max();

constexpr double kLeastDistance = 1e-12;  ///< m; replaces an attenuationDistance of 0, which glTF forbids

/// Clamps a number to [lower, upper], with a warning if it was outside; fails if it is not finite.
float limited(Import& import, double value, double lower, double upper, const std::string& place) {
  if (!std::isfinite(value)) import.fail(place, "is not finite");
  if (value < lower || value > upper) {
    import.scene.warnings.push_back(place + ": " + std::to_string(value) + " brought into its range " +
                                    (upper == kNoUpper ? "from " + std::to_string(lower) + " up"
                                                       : std::to_string(lower) + " .. " + std::to_string(upper)));
  }
  return float(std::clamp(value, lower, upper));
}

Rgb limited_colour(Import& import, const std::vector<double>& values, Rgb fallback, double upper,
                   const std::string& place) {
  if (values.empty()) return fallback;
  if (values.size() < 3) import.fail(place, "must have 3 numbers");
  Rgb colour;
  for (int c = 0; c < 3; ++c) colour[c] = limited(import, values[std::size_t(c)], 0, upper, place);
  return colour;
}

void ignore_texture(const ExtensionReader& reader, const char* key) {
  if (reader.object.Has(key))
    reader.import.ignore(std::string(key) + " (the material keeps its factor)", 1,
                         reader.place.substr(0, reader.place.find(".extensions")));
}

/// Textures of the core specification.
template <class Info>
Texture read_texture(Import& import, const Info& info, const std::string& place) {
  const auto transform = info.extensions.find("KHR_texture_transform");
  return read_texture(
      import, TextureUse{info.index, info.texCoord, transform == info.extensions.end() ? nullptr : &transform->second},
      place);
}

void read_extension(const ExtensionReader& reader, const std::string& name, Material& material,
                    MaterialTextures& textures, double& emissive_strength) {
  Import& import = reader.import;
  if (!reader.object.IsObject()) import.fail(reader.place, "is not an object");
  if (name == "KHR_materials_emissive_strength") {
    emissive_strength = limited(import, reader.number("emissiveStrength", 1), 0, kNoUpper, reader.place);
  } else if (name == "KHR_materials_specular") {
    material.specular = limited(import, reader.number("specularFactor", 1), 0, 1, reader.place);
    material.specular_color =
        limited_colour(import, reader.numbers("specularColorFactor", 3), Rgb{1.0f}, kNoUpper, reader.place);
    ignore_texture(reader, "specularTexture");
    ignore_texture(reader, "specularColorTexture");
  } else if (name == "KHR_materials_ior") {
    const double ior = reader.number("ior", 1.5);
    material.ior = ior == 0 ? 0.0f : limited(import, ior, 1, kNoUpper, reader.place);
  } else if (name == "KHR_materials_transmission") {
    material.transmission = limited(import, reader.number("transmissionFactor", 0), 0, 1, reader.place);
    if (reader.object.Has("transmissionTexture"))
      textures.transmission =
          read_texture(import, reader.object.Get("transmissionTexture"), reader.place + ".transmissionTexture");
  } else if (name == "KHR_materials_volume") {
    material.thin_walled = !(reader.number("thicknessFactor", 0) > 0);
    material.attenuation_color =
        limited_colour(import, reader.numbers("attenuationColor", 3), Rgb{1.0f}, 1, reader.place);
    if (reader.object.Has("attenuationDistance"))
      material.attenuation_distance =
          limited(import, reader.number("attenuationDistance", 1), kLeastDistance, kNoUpper, reader.place);
    ignore_texture(reader, "thicknessTexture");
  } else if (name == "KHR_materials_unlit") {
    material.unlit = true;
  }
}

void read_alpha(Import& import, const tinygltf::Material& source, const std::string& place, Material& material) {
  const std::vector<double>& factor = source.pbrMetallicRoughness.baseColorFactor;
  if (source.alphaMode == "MASK") material.alpha_mode = Material::Alpha::mask;
  else if (source.alphaMode == "BLEND") material.alpha_mode = Material::Alpha::blend;
  else if (source.alphaMode != "OPAQUE")
    import.fail(place + ".alphaMode", "\"" + one_line(source.alphaMode, 40) + "\" is not OPAQUE, MASK or BLEND");
  if (factor.size() > 3) material.alpha = limited(import, factor[3], 0, 1, place + ".baseColorFactor");
  material.alpha_cutoff = limited(import, source.alphaCutoff, 0, kNoUpper, place + ".alphaCutoff");
}

Material read_material(Import& import, std::size_t index) {
  const tinygltf::Material& source = import.model.materials[index];
  const std::string place = place_of("materials", index, source.name);
  const auto& pbr = source.pbrMetallicRoughness;
  Material material;
  material.name = source.name;
  material.base_color = limited_colour(import, pbr.baseColorFactor, Rgb{1.0f}, 1, place + ".baseColorFactor");
  material.metallic = limited(import, pbr.metallicFactor, 0, 1, place + ".metallicFactor");
  material.roughness = limited(import, pbr.roughnessFactor, 0, 1, place + ".roughnessFactor");
  material.double_sided = source.doubleSided;
  read_alpha(import, source, place, material);
  double strength = 1;
  MaterialTextures textures;
  for (const auto& [name, value] : source.extensions)
    read_extension({import, value, place + ".extensions." + name}, name, material, textures, strength);
  material.emission = limited_colour(import, source.emissiveFactor, Rgb{0.0f}, kNoUpper, place + ".emissiveFactor");
  material.emission *= float(strength);
  if (!is_finite(material.emission)) import.fail(place, "emissiveFactor times emissiveStrength is not finite");
  if (material.unlit) material.emission = Rgb(0.0f);  // an unlit material shows base_color only
  textures.base_color = read_texture(import, pbr.baseColorTexture, place + ".baseColorTexture");
  textures.metallic_roughness = read_texture(import, pbr.metallicRoughnessTexture, place + ".metallicRoughnessTexture");
  textures.normal = read_texture(import, source.normalTexture, place + ".normalTexture");
  textures.normal_scale =
      limited(import, source.normalTexture.scale, -kNoUpper, kNoUpper, place + ".normalTexture.scale");
  textures.emission = read_texture(import, source.emissiveTexture, place + ".emissiveTexture");
  if (source.occlusionTexture.index >= 0) import.ignore("occlusion textures (occlusion is computed)");
  if (textures.any()) material.textures = textures;
  return material;
}

PunctualLight read_light(Import& import, std::size_t index) {
  const tinygltf::Light& source = import.model.lights[index];
  const std::string place = place_of("extensions.KHR_lights_punctual.lights", index, source.name);
  PunctualLight light;
  light.name = source.name;
  if (source.type == "point") light.kind = PunctualLight::Kind::point;
  else if (source.type == "spot") light.kind = PunctualLight::Kind::spot;
  else if (source.type == "directional") light.kind = PunctualLight::Kind::directional;
  else import.fail(place + ".type", "\"" + source.type + "\" is not point, spot or directional");
  light.intensity = limited_colour(import, source.color, Rgb{1.0f}, kNoUpper, place + ".color");
  light.intensity *= limited(import, source.intensity, 0, kNoUpper, place + ".intensity");
  if (!is_finite(light.intensity)) import.fail(place, "color times intensity is not finite");
  if (light.kind == PunctualLight::Kind::spot) {
    // An animated angle is brought into the same range (animate_properties.cpp).
    const double outer = std::clamp(source.spot.outerConeAngle, kNarrowestSpot, kWidestSpot);
    light.outer_cone_rad =
        limited(import, source.spot.outerConeAngle, kNarrowestSpot, kWidestSpot, place + ".spot.outerConeAngle");
    light.inner_cone_rad =
        std::min(limited(import, source.spot.innerConeAngle, 0, outer, place + ".spot.innerConeAngle"),
                 float(outer * kSharpestSpot));
  }
  if (source.range > 0) import.ignore("range of lights (light follows the inverse square)");
  return light;
}

Camera read_camera(Import& import, std::size_t index) {
  const tinygltf::Camera& source = import.model.cameras[index];
  const std::string place = place_of("cameras", index, source.name);
  Camera camera;
  camera.name = source.name;
  if (source.type == "perspective") {
    camera.kind = Camera::Kind::perspective;
    camera.yfov_rad = source.perspective.yfov;
    if (!(camera.yfov_rad > 0 && camera.yfov_rad < std::numbers::pi))
      import.fail(place + ".perspective.yfov", "must lie between 0 and pi");
  } else if (source.type == "orthographic") {
    camera.kind = Camera::Kind::orthographic;
    camera.ymag_m = source.orthographic.ymag;
    if (!(camera.ymag_m > 0 && std::isfinite(camera.ymag_m)))
      import.fail(place + ".orthographic.ymag", "must be above 0");
  } else {
    import.fail(place + ".type", "\"" + source.type + "\" is not perspective or orthographic");
  }
  if (const auto shift = import.gated->lens_shifts.find(index); shift != import.gated->lens_shifts.end())
    camera.lens_shift = shift->second;
  return camera;
}

}  // namespace

void import_materials(Import& import) {
  for (std::size_t i = 0; i < import.model.materials.size(); ++i)
    import.scene.materials.push_back(read_material(import, i));
  import.scene.materials.emplace_back();  // glTF's default material, for primitives without one
}

void import_lights(Import& import) {
  for (std::size_t i = 0; i < import.model.lights.size(); ++i) import.scene.lights.push_back(read_light(import, i));
}

void import_cameras(Import& import) {
  for (std::size_t i = 0; i < import.model.cameras.size(); ++i) import.scene.cameras.push_back(read_camera(import, i));
}

}  // namespace tempolux::gltf
