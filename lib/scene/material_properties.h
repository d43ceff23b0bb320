// lib/scene/material_properties.h -- the table of material properties. The reader of files, the list of known
// extensions, animation pointers and their setter, the names of changes, and the hash of materials go through its rows.
// A property that is not in the table does not compile (material_properties.cpp counts the members).
#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "lib/scene/scene.h"

namespace tempolux {

/// Name of the extension that a JSON pointer inside a material names; empty for the core specification.
std::string_view extension_of(std::string_view pointer);

/// What a property's number means for its member.
enum class PropertyRole : std::uint8_t {
  value,              ///< the member is the number, brought into its limits
  colour_and_alpha,   ///< a fourth number is Material::alpha
  value_or_zero,      ///< as value, but 0 is allowed below the lower limit
  emission_colour,    ///< the member is the product of the two factors of ColorFactors; this is the first
  emission_strength,  ///< and this the second
  alpha_cutoff,       ///< of alpha mode MASK alone
  solid,              ///< the member is false if the number is above 0
  presence,           ///< the member is true if the extension is there
};

/// A row of the table.
struct MaterialProperty {
  const char* name;          ///< for people
  std::string_view pointer;  ///< JSON pointer inside a material; of `presence`, that of the extension
  std::variant<float Material::*, Rgb Material::*, bool Material::*> member;
  double lower = 0, upper = std::numeric_limits<float>::max();
  PropertyRole role = PropertyRole::value;
  /// Hashed with its name, and only if it is not the default. Such rows can be added without changing the hash of a
  /// material that does not use them.
  bool hashed_if_set = false;

  /// Numbers of a value: 1, 3 or 4.
  std::size_t components() const;
  /// True if KHR_animation_pointer may change the property.
  bool animated() const { return !std::holds_alternative<bool Material::*>(member); }
  bool changes_emission() const {
    return role == PropertyRole::emission_colour || role == PropertyRole::emission_strength;
  }
};

/// A texture of a material: the keys of its reference in the file, and the member.
struct MaterialTexture {
  const char* name;
  std::string_view pointer;  ///< JSON pointer of the textureInfo inside a material
  Texture MaterialTextures::*member;
};

std::span<const MaterialProperty> material_properties();
std::span<const MaterialTexture> material_textures();

/// Sets a property from the numbers of a file or an animation, which are brought into its limits. Emission changes
/// `emission` alone; finish_emission() then sets the material's.
void set_property(const MaterialProperty& property, std::span<const double> numbers, Material& material,
                  ColorFactors& emission);
/// True if the track changes the emission of a material.
bool changes_emission(const AnimationTrack& track);
inline void finish_emission(const ColorFactors& emission, Material& material) {
  material.emission = emission.color * emission.strength;
}

}  // namespace tempolux
