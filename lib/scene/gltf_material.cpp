// lib/scene/gltf_material.cpp -- reads materials, punctual lights and cameras.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_model.h"
#include "lib/scene/lamp_size.h"
#include "lib/scene/material_properties.h"

namespace tempolux::gltf {
namespace {

using tinygltf::Value;

constexpr double kNoUpper = std::numeric_limits<float>::max();

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
  if (values.size() < 3) {
    import.mend(place, "a colour of fewer than 3 numbers is left out", 1);
    return fallback;
  }
  Rgb colour;
  for (int c = 0; c < 3; ++c) colour[c] = limited(import, values[std::size_t(c)], 0, upper, place);
  return colour;
}

/// Notes a colour above 1, which glTF does not have; it is used as it is, since older exporters write bright light so.
void note_bright(Import& import, const std::vector<double>& values, const std::string& place) {
  if (std::ranges::any_of(values, [](double v) { return v > 1; }))
    import.mend(place, "a colour above 1, which glTF does not allow, is taken as it is", 1);
}

void ignore_texture(const ExtensionReader& reader, const char* key) {
  if (reader.object.Has(key))
    reader.import.ignore(std::string(key) + " (the material keeps its factor)", 1,
                         reader.place.substr(0, reader.place.find(".extensions")));
}

/// A JSON pointer inside a material, taken apart.
struct PropertyPlace {
  std::string extension;  ///< name of the extension that has the property; empty for the core specification
  std::string parent;     ///< the pointer without its last name
  std::string key;        ///< the pointer's last name

  explicit PropertyPlace(std::string_view pointer)
      : extension(extension_of(pointer)),
        parent(pointer.substr(0, pointer.rfind('/'))),
        key(pointer.substr(pointer.rfind('/') + 1)) {}
  /// As places are written in messages: ".extensions.NAME.key"; of the core specification the key alone.
  std::string dotted() const { return (extension.empty() ? "." : ".extensions." + extension + ".") + key; }
};

/// The numbers of a property of a material; empty: the file has none, and the default holds.
std::vector<double> numbers_of(Import& import, const tinygltf::Material& source, const MaterialProperty& property,
                               const std::string& place) {
  const PropertyPlace at(property.pointer);
  if (!at.extension.empty()) {
    const auto extension = source.extensions.find(at.extension);
    if (extension == source.extensions.end()) return {};
    const std::string object = place + ".extensions." + at.extension;
    if (!extension->second.IsObject()) return {};  // the gate has left it out
    if (property.role == PropertyRole::presence) return {1};
    if (!extension->second.Has(at.key)) return {};
    const ExtensionReader reader{import, extension->second, object};
    if (property.components() > 1) return reader.numbers(at.key.c_str(), property.components());
    const tinygltf::Value& value = extension->second.Get(at.key);
    if (value.IsNumber()) return {reader.number(at.key.c_str(), 0)};
    import.mend(object + "." + at.key, "what is not a number is left out", 1);
    return {};
  }
  const tinygltf::ParameterMap& values = at.parent.empty() ? source.additionalValues : source.values;
  const auto found = values.find(at.key);
  if (found == values.end()) return {};
  if (property.components() == 1)
    return {found->second.has_number_value ? found->second.number_value : double(found->second.bool_value)};
  if (found->second.number_array.size() < property.components()) {
    const std::size_t count = found->second.number_array.size();
    const bool colour = count == 3 && property.role == PropertyRole::colour_and_alpha;
    import.mend(place + at.dotted(),
                colour ? "a colour without alpha gets alpha 1"
                       : std::to_string(count) + " numbers where " + std::to_string(property.components()) +
                             " are needed are left out",
                1);
    if (!colour) return {};
  }
  return found->second.number_array;
}

/// Fails for a number that is not finite; warns of one that set_property() will bring into its limits.
void check_numbers(Import& import, const MaterialProperty& property, const std::vector<double>& numbers,
                   const std::string& place) {
  const std::string at = place + PropertyPlace(property.pointer).dotted();
  if (property.role == PropertyRole::emission_colour) note_bright(import, numbers, at);
  for (const double number : numbers)
    if (!(property.role == PropertyRole::value_or_zero && number == 0))
      limited(import, number, property.lower, property.upper, at);
}

/// Textures that the specification has and this program does not read.
void ignore_textures(Import& import, const tinygltf::Material& source, const std::string& place) {
  if (const auto found = source.extensions.find("KHR_materials_volume"); found != source.extensions.end())
    ignore_texture({import, found->second, place + ".extensions.KHR_materials_volume"}, "thicknessTexture");
  if (source.occlusionTexture.index >= 0) import.ignore("occlusion textures (occlusion is computed)");
}

void read_alpha_mode(Import& import, const tinygltf::Material& source, const std::string& place, Material& material) {
  if (source.alphaMode == "MASK") material.alpha_mode = Material::Alpha::mask;
  else if (source.alphaMode == "BLEND") material.alpha_mode = Material::Alpha::blend;
  else if (source.alphaMode != "OPAQUE")
    import.mend(place + ".alphaMode",
                "\"" + one_line(source.alphaMode, 40) + "\" is not OPAQUE, MASK or BLEND; it counts as OPAQUE", 1);
}

/// The reference to a texture of the core specification, by its key.
TextureUse core_texture(const tinygltf::Material& source, std::string_view key) {
  const auto use = [](const auto& info) {
    const auto transform = info.extensions.find("KHR_texture_transform");
    return TextureUse{info.index, info.texCoord, transform == info.extensions.end() ? nullptr : &transform->second};
  };
  return key == "baseColorTexture"           ? use(source.pbrMetallicRoughness.baseColorTexture)
         : key == "metallicRoughnessTexture" ? use(source.pbrMetallicRoughness.metallicRoughnessTexture)
         : key == "normalTexture"            ? use(source.normalTexture)
                                             : use(source.emissiveTexture);
}

MaterialTextures read_textures(Import& import, const tinygltf::Material& source, const std::string& place) {
  MaterialTextures textures;
  for (const MaterialTexture& texture : material_textures()) {
    const PropertyPlace at(texture.pointer);
    const std::string there = place + at.dotted();
    if (at.extension.empty()) {
      textures.*texture.member = read_texture(import, core_texture(source, at.key), there);
    } else if (const auto found = source.extensions.find(at.extension);
               found != source.extensions.end() && found->second.Has(at.key)) {
      textures.*texture.member = read_texture(import, found->second.Get(at.key), there);
    }
  }
  textures.normal_scale =
      limited(import, source.normalTexture.scale, -kNoUpper, kNoUpper, place + ".normalTexture.scale");
  if (textures.clearcoat_normal) {
    const std::string there = place + ".extensions.KHR_materials_clearcoat.clearcoatNormalTexture";
    const Value& info = source.extensions.at("KHR_materials_clearcoat").Get("clearcoatNormalTexture");
    textures.clearcoat_normal_scale =
        limited(import, ExtensionReader{import, info, there}.number("scale", 1), -kNoUpper, kNoUpper, there + ".scale");
  }
  return textures;
}

/// Decides which two sets of texture coordinates, TEXCOORD_n, the primitives of a material keep. These are 0 and 1
/// unless a texture reads a further set. Then they are the first two sets that are read in the order of
/// material_textures(), base colour first: the textures get the numbers 0 and 1 in place of the sets' own, and textures
/// on a third set are left out. An anisotropy without a texture reads TEXCOORD_0 for its direction. Returns the sets.
std::array<std::uint32_t, 2> number_uv_sets(Import& import, MaterialTextures& textures) {
  std::array<std::uint32_t, 2> sets{kNone, kNone};
  bool beyond = false;
  for (const MaterialTexture& row : material_textures())
    beyond |= textures.*row.member && (textures.*row.member).uv_set > 1;
  if (!beyond) return {0, 1};
  for (const MaterialTexture& row : material_textures()) {
    Texture& texture = textures.*row.member;
    if (!texture && !(textures.grain && row.member == &MaterialTextures::anisotropy)) continue;
    const auto slot = std::ranges::find_if(sets, [&](std::uint32_t s) { return s == kNone || s == texture.uv_set; });
    if (slot == sets.end()) {
      if (texture) import.ignore("textures on a third set of coordinates of their material");
      texture = {};
      continue;
    }
    *slot = texture.uv_set;
    texture.uv_set = std::uint32_t(slot - sets.begin());
  }
  return sets;
}

Material read_material(Import& import, std::size_t index, ColorFactors& emission) {
  const tinygltf::Material& source = import.model.materials[index];
  const std::string place = place_of("materials", index, source.name);
  Material material;
  material.name = source.name;
  read_alpha_mode(import, source, place, material);
  emission = {Rgb{0.0f}, 1};
  for (const MaterialProperty& property : material_properties()) {
    const std::vector<double> numbers = numbers_of(import, source, property, place);
    check_numbers(import, property, numbers, place);
    if (!numbers.empty()) set_property(property, numbers, material, emission);
  }
  finish_emission(emission, material);
  if (!is_finite(material.emission)) import.fail(place, "emissiveFactor times emissiveStrength is not finite");
  if (material.unlit) material.emission = Rgb(0.0f);  // an unlit material shows base_color only
  MaterialTextures textures = read_textures(import, source, place);
  read_specular_glossiness(import, source, place, material, textures);
  textures.grain = source.extensions.contains("KHR_materials_anisotropy");
  import.uv_sets.push_back(number_uv_sets(import, textures));
  if (textures.any()) material.textures = textures;
  ignore_textures(import, source, place);
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
  note_bright(import, source.color, place + ".color");
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
  if (const auto extras = import.gated->light_extras.find(index); extras != import.gated->light_extras.end())
    light.size = read_lamp_size(extras->second, light.kind, import.scene.path + ": " + place, import.scene.warnings);
  if (source.range != 0) import.ignore("range of lights (light follows the inverse square)");
  return light;
}

Camera read_camera(Import& import, std::size_t index) {
  const tinygltf::Camera& source = import.model.cameras[index];
  const std::string place = place_of("cameras", index, source.name);
  Camera camera;
  camera.name = source.name;
  if (source.type == "perspective") {  // mend_cameras() has checked the type and the angle
    camera.kind = Camera::Kind::perspective;
    camera.yfov_rad = source.perspective.yfov;
  } else {
    camera.kind = Camera::Kind::orthographic;
    camera.ymag_m = source.orthographic.ymag;
  }
  if (const auto shift = import.gated->lens_shifts.find(index); shift != import.gated->lens_shifts.end())
    camera.lens_shift = shift->second;
  return camera;
}

}  // namespace

void import_materials(Import& import) {
  for (std::size_t i = 0; i < import.model.materials.size(); ++i)
    import.scene.materials.push_back(read_material(import, i, import.emission_factors.emplace_back()));
  import.scene.materials.emplace_back();  // glTF's default material, for primitives without one
  import.emission_factors.push_back({Rgb{0.0f}, 1});
}

void import_lights(Import& import) {
  for (std::size_t i = 0; i < import.model.lights.size(); ++i) import.scene.lights.push_back(read_light(import, i));
}

void import_cameras(Import& import) {
  for (std::size_t i = 0; i < import.model.cameras.size(); ++i) import.scene.cameras.push_back(read_camera(import, i));
}

}  // namespace tempolux::gltf
