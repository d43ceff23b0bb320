// lib/scene/gltf_texture.cpp -- reads images, samplers and transforms of texture coordinates.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/scene/base64.h"
#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_model.h"

namespace tempolux::gltf {
namespace {

using tinygltf::Value;

/// Bytes of an image. If the image is a file of its own, the file is added to Scene::files.
std::vector<unsigned char> image_bytes(Import& import, const GatedImage& image, const std::string& place) {
  if (!image.refused.empty()) import.fail(place, image.refused);
  if (image.buffer_view >= 0) {
    if (std::size_t(image.buffer_view) >= import.model.bufferViews.size())
      import.fail(place, "bufferView " + std::to_string(image.buffer_view) + " does not exist");
    // check_accessors has checked that views lie inside their buffers.
    const tinygltf::BufferView& view = import.model.bufferViews[std::size_t(image.buffer_view)];
    const auto first = import.model.buffers[std::size_t(view.buffer)].data.begin() + std::ptrdiff_t(view.byteOffset);
    return {first, first + std::ptrdiff_t(view.byteLength)};
  }
  if (image.path.empty()) {
    std::optional<std::vector<unsigned char>> decoded = base64_bytes(image.base64);
    if (!decoded) import.fail(place, "holds characters that are not base64");
    return std::move(*decoded);
  }
  require_file(image.path, import.scene.path, place);
  std::vector<unsigned char> bytes = read_whole(image.path, import.options->max_file_bytes);
  std::vector<std::string>& files = import.scene.files;
  if (std::find(files.begin(), files.end(), image.path) == files.end()) files.push_back(image.path);
  return bytes;
}

/// Index in the scene of an image of the file; the image is read at its first use.
std::uint32_t image_of(Import& import, std::size_t source) {
  const std::vector<GatedImage>& images = import.gated->images;
  import.image_from_source.resize(images.size(), kNone);
  if (import.image_from_source[source] != kNone) return import.image_from_source[source];
  const std::string place = place_of("images", source, images[source].name);
  EncodedImage image;
  image.bytes = image_bytes(import, images[source], place);
  image.place = images[source].path.empty() ? import.scene.path + ": " + place : images[source].path;
  const ImageHeader header = read_image_header(image.bytes, image.place);
  image.width = header.width;
  image.height = header.height;
  if (header.four_inks)
    import.mend(place,
                "a JPEG of four inks (CMYK) is read without its colour profile; save it as RGB for exact colours", 1);
  const std::string size = std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels";
  const TextureLimits& limits = import.options->textures;
  if (std::uint64_t(image.width) * std::uint64_t(image.height) > limits.max_pixels)
    throw InputError(image.place + ": " + size + ", over the limit of " + std::to_string(limits.max_pixels) +
                     "; make it smaller");
  if (const int side = std::max(image.width, image.height); side > limits.max_side)
    throw InputError(image.place + ": " + size + ", over " + std::to_string(limits.max_side) +
                     " on a side; make it smaller");
  Hasher hasher;
  hasher.add_bytes(image.bytes.data(), image.bytes.size());
  image.digest = hasher.hex();
  import.images.push_back(std::move(image));
  return import.image_from_source[source] = std::uint32_t(import.images.size() - 1);
}

Texture::Wrap wrap_of(Import& import, int mode, const std::string& place) {
  if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Texture::Wrap::mirrored;
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
  if (mode != TINYGLTF_TEXTURE_WRAP_REPEAT)
    import.mend(place, "wrap mode " + std::to_string(mode) + " is not one of glTF's; the texture repeats", 1);
  return Texture::Wrap::repeat;
}

/// Notes filters that glTF does not have; linear filters replace them.
void check_filters(Import& import, const tinygltf::Sampler& sampler, const std::string& place) {
  constexpr int nearest = TINYGLTF_TEXTURE_FILTER_NEAREST, linear = TINYGLTF_TEXTURE_FILTER_LINEAR;
  constexpr int first = TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST,
                last = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
  const auto note = [&](const char* key, int filter) {
    import.mend(place + key, "filter " + std::to_string(filter) + " is not one of glTF's; the texture is interpolated",
                1);
  };
  if (const int mag = sampler.magFilter; mag != -1 && mag != nearest && mag != linear) note(".magFilter", mag);
  if (const int min = sampler.minFilter; min != -1 && min != nearest && min != linear && (min < first || min > last))
    note(".minFilter", min);
}

bool is_finite_number(const Value& value) { return value.IsNumber() && std::isfinite(value.GetNumberAsDouble()); }

/// A whole number from 0 to 2147483647, or -1 for any other number.
int whole(double number) {
  return number >= 0 && number < 2147483648.0 && number == std::floor(number) ? int(number) : -1;
}

/// Reads KHR_texture_transform as a matrix: offset + R scale uv. In the specification's text and in all renderers, a
/// positive rotation turns coordinates counter-clockwise as seen with v downwards: (1, 0) turns towards (0, -1). The
/// specification's example code has the opposite sign (Khronos' issue 1563).
void read_transform(Import& import, const Value& value, const std::string& place, Texture& texture) {
  if (!value.IsObject()) return import.mend(place, "is not an object; the texture is not moved", 1);
  const ExtensionReader reader{import, value, place};
  std::vector<double> offset = reader.numbers("offset", 2), scale = reader.numbers("scale", 2);
  offset.resize(2, 0), scale.resize(2, 1);
  const double angle = reader.number("rotation", 0), c = std::cos(angle), s = std::sin(angle);
  texture.transform = {float(c * scale[0]),  float(s * scale[1]), float(offset[0]),
                       float(-s * scale[0]), float(c * scale[1]), float(offset[1])};
  const int uv_set = whole(reader.number("texCoord", texture.uv_set));
  if (uv_set >= 0) texture.uv_set = std::uint32_t(uv_set);
  else import.mend(place + ".texCoord", "what is not a whole number from 0 to 2147483647 is left out", 1);
}

}  // namespace

double ExtensionReader::number(const char* key, double fallback) const {
  if (!object.Has(key)) return fallback;
  if (!is_finite_number(object.Get(key))) {
    import.mend(place + "." + key, "what is not a finite number is replaced by " + std::to_string(fallback), 1);
    return fallback;
  }
  return object.Get(key).GetNumberAsDouble();
}

std::vector<double> ExtensionReader::numbers(const char* key, std::size_t count) const {
  std::vector<double> values;
  if (!object.Has(key)) return values;
  const Value& array = object.Get(key);
  for (std::size_t i = 0; i < array.ArrayLen(); ++i)
    if (is_finite_number(array.Get(int(i)))) values.push_back(array.Get(int(i)).GetNumberAsDouble());
  if (array.ArrayLen() != count || values.size() != count) {
    import.mend(place + "." + key, "what is not " + std::to_string(count) + " finite numbers is left out", 1);
    values.clear();
  }
  return values;
}

Texture read_texture(Import& import, const TextureUse& use, const std::string& place) {
  Texture texture;
  if (use.index < 0) return texture;
  if (std::size_t(use.index) >= import.model.textures.size()) {
    import.mend(place + ".index", "texture " + std::to_string(use.index) + " does not exist; it is left out", 1);
    return texture;
  }
  const std::string texture_place = place_of("textures", std::size_t(use.index));
  const tinygltf::Texture& source = import.model.textures[std::size_t(use.index)];
  texture.uv_set = std::uint32_t(use.uv_set);
  if (use.transform) read_transform(import, *use.transform, place + ".extensions.KHR_texture_transform", texture);
  if (source.sampler >= 0) {
    const bool exists = std::size_t(source.sampler) < import.model.samplers.size();
    if (!exists)
      import.mend(texture_place + ".sampler",
                  "sampler " + std::to_string(source.sampler) + " does not exist; the texture repeats", 1);
    const tinygltf::Sampler by_default;
    const tinygltf::Sampler& sampler = exists ? import.model.samplers[std::size_t(source.sampler)] : by_default;
    const std::string sampler_place = place_of("samplers", std::size_t(source.sampler));
    texture.wrap_u = wrap_of(import, sampler.wrapS, sampler_place + ".wrapS");
    texture.wrap_v = wrap_of(import, sampler.wrapT, sampler_place + ".wrapT");
    check_filters(import, sampler, sampler_place);
    texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  }
  if (source.source < 0)
    import.fail(
        texture_place,
        "names no PNG, JPEG, WebP or AVIF image; convert its textures with `gltf-transform png IN.glb OUT.glb`");
  if (std::size_t(source.source) >= import.gated->images.size()) {
    import.mend(texture_place + ".source",
                "image " + std::to_string(source.source) + " does not exist; the texture is left out", 1);
    return Texture{};
  }
  texture.image = image_of(import, std::size_t(source.source));
  return texture;
}

Texture read_texture(Import& import, const Value& info, const std::string& place) {
  if (!info.IsObject()) {
    import.mend(place, "is not an object; the texture is left out", 1);
    return Texture{};
  }
  const ExtensionReader reader{import, info, place};
  TextureUse use{whole(reader.number("index", -1)), whole(reader.number("texCoord", 0)), nullptr};
  if (use.index < 0 || use.uv_set < 0) {
    import.mend(place, "index and texCoord must be whole numbers from 0 to 2147483647; the texture is left out", 1);
    return Texture{};
  }
  if (info.Has("extensions") && info.Get("extensions").Has("KHR_texture_transform"))
    use.transform = &info.Get("extensions").Get("KHR_texture_transform");
  return read_texture(import, use, place);
}

}  // namespace tempolux::gltf
