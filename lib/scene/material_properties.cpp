#include "lib/scene/material_properties.h"

#include <algorithm>
#include <array>

namespace tempolux {
namespace {

using enum PropertyRole;
using M = Material;

constexpr double kNoUpper = std::numeric_limits<float>::max();
constexpr double kLeastDistance = 1e-12;  ///< m; replaces an attenuationDistance of 0, which glTF forbids

constexpr std::array kProperties{
    MaterialProperty{"base colour", "/pbrMetallicRoughness/baseColorFactor", &M::base_color, 0, 1, colour_and_alpha},
    MaterialProperty{"alpha cutoff", "/alphaCutoff", &M::alpha_cutoff, 0, kNoUpper, alpha_cutoff},
    MaterialProperty{"metallic", "/pbrMetallicRoughness/metallicFactor", &M::metallic, 0, 1},
    MaterialProperty{"roughness", "/pbrMetallicRoughness/roughnessFactor", &M::roughness, 0, 1},
    MaterialProperty{"emissive factor", "/emissiveFactor", &M::emission, 0, kNoUpper, emission_colour},
    MaterialProperty{"emissive strength", "/extensions/KHR_materials_emissive_strength/emissiveStrength", &M::emission,
                     0, kNoUpper, emission_strength},
    MaterialProperty{"specular", "/extensions/KHR_materials_specular/specularFactor", &M::specular, 0, 1},
    MaterialProperty{"specular colour", "/extensions/KHR_materials_specular/specularColorFactor", &M::specular_color},
    MaterialProperty{"ior", "/extensions/KHR_materials_ior/ior", &M::ior, 1, kNoUpper, value_or_zero},
    MaterialProperty{"transmission", "/extensions/KHR_materials_transmission/transmissionFactor", &M::transmission, 0,
                     1},
    MaterialProperty{"thickness", "/extensions/KHR_materials_volume/thicknessFactor", &M::thin_walled, 0, kNoUpper,
                     solid},
    MaterialProperty{"attenuation colour", "/extensions/KHR_materials_volume/attenuationColor", &M::attenuation_color,
                     0, 1},
    MaterialProperty{"attenuation distance", "/extensions/KHR_materials_volume/attenuationDistance",
                     &M::attenuation_distance, kLeastDistance},
    MaterialProperty{"dispersion", "/extensions/KHR_materials_dispersion/dispersion", &M::dispersion, 0, kNoUpper,
                     value, true},
    MaterialProperty{"double sided", "/doubleSided", &M::double_sided},
    MaterialProperty{"unlit", "/extensions/KHR_materials_unlit", &M::unlit, 0, kNoUpper, presence},
    MaterialProperty{"clearcoat", "/extensions/KHR_materials_clearcoat/clearcoatFactor", &M::clearcoat, 0, 1, value,
                     true},
    MaterialProperty{"clearcoat roughness", "/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
                     &M::clearcoat_roughness, 0, 1, value, true},
    MaterialProperty{"iridescence", "/extensions/KHR_materials_iridescence/iridescenceFactor", &M::iridescence, 0, 1,
                     value, true},
    MaterialProperty{"iridescence ior", "/extensions/KHR_materials_iridescence/iridescenceIor", &M::iridescence_ior, 1,
                     kNoUpper, value, true},
    MaterialProperty{"iridescence thickness minimum",
                     "/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum",
                     &M::iridescence_thickness_minimum, 0, kNoUpper, value, true},
    MaterialProperty{"iridescence thickness maximum",
                     "/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum",
                     &M::iridescence_thickness_maximum, 0, kNoUpper, value, true},
    MaterialProperty{"sheen colour", "/extensions/KHR_materials_sheen/sheenColorFactor", &M::sheen_color, 0, 1, value,
                     true},
    MaterialProperty{"sheen roughness", "/extensions/KHR_materials_sheen/sheenRoughnessFactor", &M::sheen_roughness, 0,
                     1, value, true},
    MaterialProperty{"anisotropy", "/extensions/KHR_materials_anisotropy/anisotropyStrength", &M::anisotropy, 0, 1,
                     value, true},
    MaterialProperty{"anisotropy rotation", "/extensions/KHR_materials_anisotropy/anisotropyRotation",
                     &M::anisotropy_rotation, -kNoUpper, kNoUpper, value, true},
    MaterialProperty{"diffuse transmission", "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor",
                     &M::diffuse_transmission, 0, 1, value, true},
    MaterialProperty{"diffuse transmission colour",
                     "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor",
                     &M::diffuse_transmission_color, 0, 1, value, true}};

using T = MaterialTextures;
constexpr std::array kTextures{
    MaterialTexture{"base colour", "/pbrMetallicRoughness/baseColorTexture", &T::base_color},
    MaterialTexture{"metallic roughness", "/pbrMetallicRoughness/metallicRoughnessTexture", &T::metallic_roughness},
    MaterialTexture{"normal", "/normalTexture", &T::normal},
    MaterialTexture{"emission", "/emissiveTexture", &T::emission},
    MaterialTexture{"transmission", "/extensions/KHR_materials_transmission/transmissionTexture", &T::transmission},
    MaterialTexture{"specular", "/extensions/KHR_materials_specular/specularTexture", &T::specular},
    MaterialTexture{"specular colour", "/extensions/KHR_materials_specular/specularColorTexture", &T::specular_color},
    MaterialTexture{"clearcoat", "/extensions/KHR_materials_clearcoat/clearcoatTexture", &T::clearcoat},
    MaterialTexture{"clearcoat roughness", "/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
                    &T::clearcoat_roughness},
    MaterialTexture{"clearcoat normal", "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
                    &T::clearcoat_normal},
    MaterialTexture{"iridescence", "/extensions/KHR_materials_iridescence/iridescenceTexture", &T::iridescence},
    MaterialTexture{"iridescence thickness", "/extensions/KHR_materials_iridescence/iridescenceThicknessTexture",
                    &T::iridescence_thickness},
    MaterialTexture{"sheen colour", "/extensions/KHR_materials_sheen/sheenColorTexture", &T::sheen_color},
    MaterialTexture{"sheen roughness", "/extensions/KHR_materials_sheen/sheenRoughnessTexture", &T::sheen_roughness},
    MaterialTexture{"anisotropy", "/extensions/KHR_materials_anisotropy/anisotropyTexture", &T::anisotropy},
    MaterialTexture{"diffuse transmission", "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture",
                    &T::diffuse_transmission},
    MaterialTexture{"diffuse transmission colour",
                    "/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
                    &T::diffuse_transmission_color}};

// A new member changes these counts. It needs a row above, in which reader, hash and animation find it.
[[maybe_unused]] constexpr auto members = [](const MaterialValues& values) {
  [[maybe_unused]] const auto& [base_color, metallic, roughness, emission, specular, specular_color, ior, transmission,
                                thin_walled, attenuation_color, attenuation_distance, dispersion, double_sided, unlit,
                                clearcoat, clearcoat_roughness, iridescence, iridescence_ior,
                                iridescence_thickness_minimum, iridescence_thickness_maximum, sheen_color,
                                sheen_roughness, anisotropy, anisotropy_rotation, diffuse_transmission,
                                diffuse_transmission_color, axes, from_far_side] = values;
  return 28;
};
// Besides: alpha cutoff, the second factor of the emission. axes and from_far_side are of a hit, not of the file.
static_assert(kProperties.size() == 28 + 2 - 2);
[[maybe_unused]] constexpr auto members_of_textures = [](const MaterialTextures& values) {
  [[maybe_unused]] const auto& [base_color, metallic_roughness, normal, emission, transmission, specular,
                                specular_color, clearcoat, clearcoat_roughness, clearcoat_normal, sheen_color,
                                sheen_roughness, anisotropy, diffuse_transmission, diffuse_transmission_color,
                                iridescence, iridescence_thickness, normal_scale, clearcoat_normal_scale, grain,
                                vertex_colors] = values;
  return 21;
};
static_assert(kTextures.size() == 21 - 4);  // the scales, vertex_colors and grain are no textures

Rgb limited_colour(std::span<const double> numbers, const MaterialProperty& property) {
  Rgb colour;
  for (int c = 0; c < 3; ++c) colour[c] = float(std::clamp(numbers[std::size_t(c)], property.lower, property.upper));
  return colour;
}

}  // namespace

std::string_view extension_of(std::string_view pointer) {
  constexpr std::string_view kPrefix = "/extensions/";
  if (!pointer.starts_with(kPrefix)) return {};
  const std::string_view rest = pointer.substr(kPrefix.size());
  return rest.substr(0, rest.find('/'));
}

std::size_t MaterialProperty::components() const {
  return role == colour_and_alpha                                                       ? 4
         : std::holds_alternative<Rgb Material::*>(member) && role != emission_strength ? 3
                                                                                        : 1;
}

std::span<const MaterialProperty> material_properties() { return kProperties; }
std::span<const MaterialTexture> material_textures() { return kTextures; }

bool changes_emission(const AnimationTrack& track) {
  return track.path == AnimationTrack::Path::material && kProperties[track.property].changes_emission();
}

void set_property(const MaterialProperty& property, std::span<const double> numbers, Material& material,
                  ColorFactors& emission) {
  const auto number = [&] { return float(std::clamp(numbers[0], property.lower, property.upper)); };
  switch (property.role) {
    case emission_colour: emission.color = limited_colour(numbers, property); return;
    case emission_strength: emission.strength = number(); return;
    case solid: material.*std::get<bool Material::*>(property.member) = !(numbers[0] > 0); return;
    case colour_and_alpha:
      if (numbers.size() > 3) material.alpha = float(std::clamp(numbers[3], 0.0, 1.0));
      break;
    case value_or_zero:
      if (numbers[0] == 0) {
        material.*std::get<float Material::*>(property.member) = 0;
        return;
      }
      break;
    default: break;
  }
  if (const auto* one = std::get_if<float Material::*>(&property.member)) material.** one = number();
  else if (const auto* colour = std::get_if<Rgb Material::*>(&property.member))
    material.** colour = limited_colour(numbers, property);
  else material.*std::get<bool Material::*>(property.member) = numbers[0] != 0;
}

}  // namespace tempolux
