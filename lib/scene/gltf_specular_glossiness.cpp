// lib/scene/gltf_specular_glossiness.cpp -- reads specular-glossiness materials as metallic-roughness ones.
#include "lib/image/specular_glossiness.h"

#include <algorithm>

#include "formats/hash.h"
#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {
namespace {

constexpr const char* kName = "KHR_materials_pbrSpecularGlossiness";

/// Numbers from 0 to 1 of the extension; `count` ones where it has none.
std::vector<double> shares(const ExtensionReader& reader, const char* key, std::size_t count) {
  std::vector<double> values = count == 1 ? std::vector{reader.number(key, 1)} : reader.numbers(key, count);
  values.resize(count, 1);
  for (double& value : values) {
    if (value < 0 || value > 1)
      reader.import.mend(reader.place + "." + key, "what is below 0 or above 1 is brought into this range", 1);
    value = std::clamp(value, 0.0, 1.0);
  }
  return values;
}

Texture texture_of(const ExtensionReader& reader, const char* key) {
  return reader.object.Has(key) ? read_texture(reader.import, reader.object.Get(key), reader.place + "." + key)
                                : Texture{};
}

/// True if both textures lie on the surface in the same way.
bool same_coordinates(Texture a, const Texture& b) {
  a.image = b.image;
  return a == b;
}

/// Index of the image that is made as `made` says; each is made once.
std::uint32_t made_image(Import& import, const SpecularGlossiness& made, const std::string& place) {
  EncodedImage image;
  Hasher hasher;
  hasher.add(std::string_view("specular-glossiness"));
  hasher.add(std::uint32_t(made.makes));
  for (const std::size_t source : {made.diffuse, made.specular}) {
    if (source == SpecularGlossiness::kWhite) {
      hasher.add(std::string_view("white"));
      continue;
    }
    const EncodedImage& from = import.images[source];
    hasher.add(std::string_view(from.digest));
    image.width = std::max(image.width, from.width);
    image.height = std::max(image.height, from.height);
  }
  hasher.add(made.diffuse_factor);
  hasher.add(made.specular_factor);
  hasher.add(made.glossiness_factor);
  image.digest = hasher.hex();
  for (std::size_t i = 0; i < import.images.size(); ++i)
    if (import.images[i].digest == image.digest) return std::uint32_t(i);
  image.place = import.scene.path + ": " + place;
  image.made_from = std::make_shared<const SpecularGlossiness>(made);
  import.images.push_back(std::move(image));
  return std::uint32_t(import.images.size() - 1);
}

std::size_t image_or_white(const Texture& texture) {
  return texture ? std::size_t(texture.image) : SpecularGlossiness::kWhite;
}

}  // namespace

void read_specular_glossiness(Import& import, const tinygltf::Material& source, const std::string& place,
                              Material& material, MaterialTextures& textures) {
  const auto found = source.extensions.find(kName);
  if (found == source.extensions.end() || !found->second.IsObject()) return;
  const ExtensionReader reader{import, found->second, place + ".extensions." + kName};
  const std::vector<double> diffuse = shares(reader, "diffuseFactor", 4),
                            specular = shares(reader, "specularFactor", 3);
  const float glossiness = float(shares(reader, "glossinessFactor", 1)[0]);
  const Texture diffuse_texture = texture_of(reader, "diffuseTexture");
  const Texture specular_texture = texture_of(reader, "specularGlossinessTexture");
  SpecularGlossiness made;
  made.diffuse_factor = {float(diffuse[0]), float(diffuse[1]), float(diffuse[2])};
  made.specular_factor = {float(specular[0]), float(specular[1]), float(specular[2])};
  made.glossiness_factor = glossiness;
  // Without a specular texture the conversion is exact: KHR_materials_ior's 0 makes specular_color the whole F0.
  material.base_color = made.diffuse_factor;
  material.alpha = float(diffuse[3]);
  material.metallic = 0;
  material.roughness = 1 - glossiness;
  material.ior = 0;
  material.specular = 1;
  material.specular_color = made.specular_factor;
  textures.base_color = diffuse_texture;
  textures.metallic_roughness = {};
  if (!specular_texture)
    return import.mend(reader.place,
                       "specular-glossiness is read as Lambert albedo, F0 and roughness; only the share of light "
                       "that the specular lobe leaves to the Lambert lobe is an approximation",
                       1);
  material.ior = 1.5f;
  material.specular_color = Rgb(1.0f);
  material.roughness = 1;
  made.specular = image_or_white(specular_texture);
  textures.metallic_roughness = specular_texture;
  if (diffuse_texture && !same_coordinates(diffuse_texture, specular_texture)) {
    made.makes = SpecularGlossiness::Makes::roughness;
    textures.metallic_roughness.image = made_image(import, made, reader.place);
    return import.mend(reader.place,
                       "the textures of specular-glossiness lie on other coordinates; the specular one gives the "
                       "roughness only, and F0 is .04",
                       1);
  }
  made.diffuse = image_or_white(diffuse_texture);
  textures.base_color = specular_texture;
  textures.base_color.image = made_image(import, made, reader.place);
  made.makes = SpecularGlossiness::Makes::metallic_roughness;
  textures.metallic_roughness.image = made_image(import, made, reader.place);
  material.base_color = Rgb(1.0f);
  material.metallic = 1;
  import.mend(reader.place,
              "specular-glossiness with a specular texture is read as metallic-roughness; an F0 below .04 becomes "
              ".04, and R, G and B share one metallic number",
              1);
}

}  // namespace tempolux::gltf
