// lib/scene/gltf_gate.cpp -- checks a glTF file before tinygltf reads it.
#include "lib/scene/gltf_gate.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>

#include "formats/error.h"
#include "lib/image/byte_file.h"
#include "lib/scene/gltf_extensions.h"
#include "lib/scene/gltf_json.h"
#include "lib/scene/gltf_unpack.h"
#include "lib/scene/material_properties.h"

namespace tempolux::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxJsonBytes = 1ull << 30;
constexpr double kMaxShift = 1000;  ///< heights of the picture
constexpr std::uint32_t kGlbMagic = 0x46546c67, kChunkJson = 0x4e4f534a, kChunkBin = 0x004e4942;

// Extensions that this program reads. Properties of them that it does not render cause warnings (gltf_material.cpp).
/// The extensions that this program reads: those of materials by the table of their properties.
const std::set<std::string> kKnown = [] {
  std::set<std::string> known{
      "KHR_lights_punctual",     "KHR_mesh_quantization",      "KHR_texture_transform",
      "EXT_mesh_gpu_instancing", "KHR_animation_pointer",      "EXT_texture_webp",
      "EXT_texture_avif",        "KHR_draco_mesh_compression", "EXT_meshopt_compression",
      "KHR_meshopt_compression", "KHR_node_visibility",        "KHR_materials_pbrSpecularGlossiness"};
  for (const MaterialProperty& property : material_properties())
    if (const std::string_view name = extension_of(property.pointer); !name.empty()) known.emplace(name);
  return known;
}();

/// The JSON text, and the position of the binary chunk (length 0: none).
struct Container {
  std::string json;
  ByteRange bin;
};

struct ChunkHeader {
  std::uint32_t length = 0, type = 0;
};

Container open_glb(const ByteFile& file, const std::string& path) {
  std::array<std::uint32_t, 3> header{};  // magic, version, length
  if (file.size() < 20)
    fail(path, "GLB header", "the file has " + std::to_string(file.size()) + " bytes; it is cut short");
  file.read_at(0, header.data(), sizeof header);
  if (header[1] != 2) fail(path, "GLB header", "version " + std::to_string(header[1]) + "; only 2 can be read");
  const std::uint64_t end = header[2];
  if (end > file.size())
    fail(path, "GLB header",
         "says " + std::to_string(end) + " bytes, but the file has " + std::to_string(file.size()) +
             "; it is cut short");
  Container container;
  std::uint64_t at = sizeof header;
  for (int chunk = 0; chunk < 2 && at + sizeof(ChunkHeader) <= end; ++chunk) {
    ChunkHeader chunk_header;
    file.read_at(at, &chunk_header, sizeof chunk_header);
    at += sizeof chunk_header;
    const std::string place = "GLB chunk " + std::to_string(chunk);
    if (chunk_header.length > end - at) fail(path, place, "reaches beyond the end of the file");
    if (chunk == 0) {
      if (chunk_header.type != kChunkJson) fail(path, place, "is not JSON");
      if (chunk_header.length > kMaxJsonBytes)
        fail(path, place, "has more than 1 GB of JSON; move the data into a buffer file");
      container.json.resize(chunk_header.length);
      file.read_at(at, container.json.data(), chunk_header.length);
    } else if (chunk_header.type == kChunkBin) {
      container.bin = {path, at, chunk_header.length};
    }
    at += (std::uint64_t(chunk_header.length) + 3) / 4 * 4;
  }
  return container;
}

Container open_container(const std::string& path, const GltfOptions& options) {
  const ByteFile file(path);
  if (file.size() > options.max_file_bytes)
    fail(path, "size", std::to_string(file.size()) + " bytes; the limit is " + std::to_string(options.max_file_bytes));
  std::uint32_t magic = 0;
  if (file.size() >= sizeof magic) file.read_at(0, &magic, sizeof magic);
  if (magic == kGlbMagic) return open_glb(file, path);
  if (file.size() > kMaxJsonBytes) fail(path, "size", "more than 1 GB of JSON; move the data into a buffer file");
  Container container;
  container.json.resize(file.size());
  file.read_at(0, container.json.data(), file.size());
  return container;
}

void check_version(const Json& document, const std::string& path) {
  const Json& asset = document["asset"];
  for (const char* key : {"version", "minVersion"}) {
    if (!asset.contains(key)) continue;
    const std::string version = asset[key].get<std::string>().substr(0, 20);
    if (!version.starts_with("2.") || (key[0] == 'm' && version != "2.0"))
      fail(path, std::string("asset.") + key, "is \"" + version + "\"; only glTF 2.0 can be read");
  }
}

void check_extensions(Json& document, const std::string& path, Gated& gated) {
  std::set<std::string> handled;
  check_packing(document, path, kKnown, handled, gated.warnings);
  std::set<std::string> unknown;
  prune(document, kKnown, unknown, path);
  for (const Json& used : array_of(document, "extensionsUsed"))
    if (const auto name = used.get<std::string>(); !kKnown.contains(name)) unknown.insert(name);
  std::string ignored;
  for (const std::string& name : unknown)
    if (!handled.contains(name)) ignored += (ignored.empty() ? "" : ", ") + name.substr(0, 80);
  if (!ignored.empty()) gated.warnings.push_back(path + ": ignored extensions: " + ignored);
}

/// Keeps the `extras` of nodes as text, since tinygltf would need 200 bytes for each of their values.
void keep_node_extras(const Json& document, Gated& gated) {
  const Json& nodes = array_of(document, "nodes");
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (const auto extras = nodes[i].find("extras"); extras != nodes[i].end())
      gated.node_extras.emplace(i, extras->dump());
}

/// Keeps the `extras` of the lights of KHR_lights_punctual as text.
void keep_light_extras(const Json& document, Gated& gated) {
  static const nlohmann::json::json_pointer kLights("/extensions/KHR_lights_punctual/lights");
  if (!document.contains(kLights) || !document[kLights].is_array()) return;
  const Json& lights = document[kLights];
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (lights[i].is_object() && lights[i].contains("extras"))
      gated.light_extras.emplace(i, lights[i]["extras"].dump());
}

/// Keeps the `lens_shift` of cameras' `extras`.
void keep_lens_shifts(const Json& document, const std::string& path, Gated& gated) {
  const Json& cameras = array_of(document, "cameras");
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto extras = cameras[i].find("extras");
    if (extras == cameras[i].end() || !extras->is_object() || !extras->contains("lens_shift")) continue;
    const Json& shift = (*extras)["lens_shift"];
    const auto fits = [](const Json& value) { return value.is_number() && std::abs(value.get<double>()) <= kMaxShift; };
    if (!shift.is_array() || shift.size() != 2 || !fits(shift[0]) || !fits(shift[1]))
      fail(path, "cameras[" + std::to_string(i) + "].extras.lens_shift",
           "must be two numbers from -1000 to 1000, in heights of the picture");
    gated.lens_shifts[i] = {shift[0].get<double>(), shift[1].get<double>()};
  }
}

/// Moves channels of KHR_animation_pointer to `gated`, since tinygltf drops them silently.
void keep_pointer_channels(Json& document, Gated& gated) {
  if (!document.contains("animations")) return;
  for (std::size_t a = 0; a < document["animations"].size(); ++a) {
    Json& animation = document["animations"][a];
    Json kept = Json::array();
    for (Json& channel : animation["channels"]) {
      const Json& target = channel["target"];
      if (target["path"] != "pointer") {
        kept.push_back(std::move(channel));
        continue;
      }
      const Json::json_pointer place("/extensions/KHR_animation_pointer/pointer");
      const std::string pointer =
          target.contains(place) && target[place].is_string() ? target[place].get<std::string>() : "";
      gated.pointers.push_back({a, channel["sampler"].get<int>(), pointer});
    }
    animation["channels"] = std::move(kept);
  }
}

std::string percent_decoded(const std::string& uri, const std::string& path, const std::string& place) {
  std::string decoded;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    char c = uri[i];
    if (c == '%') {
      const char *digits = uri.data() + i + 1, *const end = uri.data() + std::min(i + 3, uri.size());
      unsigned char byte = 0;
      if (end - digits != 2 || std::from_chars(digits, end, byte, 16).ptr != end)
        fail(path, place, "\"" + uri.substr(0, 80) + "\" has a % that is not followed by two hexadecimal digits");
      c = char(byte);
      i += 2;
    }
    if (c == '\0') fail(path, place, "holds a zero byte");
    decoded += c;
  }
  return decoded;
}

bool has_scheme(const std::string& uri) {
  const std::size_t end = uri.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-.");
  return end != std::string::npos && end > 0 && uri[end] == ':';
}

/// The file that a relative URI names. Symbolic links and `..` are resolved before the function checks that the file is
/// inside the scene's folder.
std::string resolved(const std::string& uri, const std::string& path, const std::string& place) {
  const std::string shown = "\"" + uri.substr(0, 80) + "\"";
  if (uri.empty()) fail(path, place, "is empty");
  if (has_scheme(uri))
    fail(path, place, shown + " is not a relative path; fetch the file and name it by a relative path");
  const fs::path relative = percent_decoded(uri, path, place);
  if (relative.is_absolute()) fail(path, place, shown + " is an absolute path; put the file into the scene's folder");
  const fs::path folder = fs::path(path).parent_path().empty() ? fs::path(".") : fs::path(path).parent_path();
  std::error_code error;
  const fs::path base = fs::weakly_canonical(folder, error), target = fs::weakly_canonical(folder / relative, error);
  if (error) fail(path, place, shown + ": " + error.message());
  const auto [base_end, target_at] = std::mismatch(base.begin(), base.end(), target.begin(), target.end());
  if (base_end != base.end()) fail(path, place, shown + " leads out of the scene's folder; put the file there");
  return (folder / relative).string();
}

/// The text after the comma of a data URI; nullopt unless the text is base64.
std::optional<std::string_view> base64_of(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos || comma > 200 || !uri.substr(0, comma).ends_with(";base64")) return std::nullopt;
  return uri.substr(comma + 1);
}

/// Checks a data URI and rewrites its head, of which tinygltf accepts only certain media types.
std::string checked_data_uri(const std::string& uri, std::uint64_t length, const std::string& path,
                             const std::string& place) {
  const std::optional<std::string_view> coded = base64_of(uri);
  if (!coded) fail(path, place, "a data URI must be base64");
  std::string_view payload = *coded;
  while (payload.ends_with('=')) payload.remove_suffix(1);
  const auto is_base64 = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '/';
  };
  if (!std::all_of(payload.begin(), payload.end(), is_base64))
    fail(path, place, "holds characters that are not base64");
  if (payload.size() * 3 / 4 != length)
    fail(
        path, place,
        "decodes to " + std::to_string(payload.size() * 3 / 4) + " bytes, but byteLength is " + std::to_string(length));
  return "data:application/octet-stream;base64," + std::string(*coded);
}

void approve_buffer(Json& buffer, std::size_t index, const std::string& path, const Container& container,
                    const GltfOptions& options, Gated& gated) {
  const std::string place = place_of("buffers", index);
  ByteRange range{path, 0, 0};
  if (is_stand_in(buffer) && (index != 0 || container.bin.length == 0)) {
    gated.buffers.push_back(range);
    return;
  }
  const std::uint64_t length = buffer["byteLength"].get<std::uint64_t>();
  if (length == 0) fail(path, place + ".byteLength", "is 0");
  if (!buffer.contains("uri")) {
    if (index != 0 || container.bin.length == 0) fail(path, place, "has no uri, and there is no binary chunk for it");
    range = container.bin;
    if (length > range.length)
      fail(path, place,
           "byteLength " + std::to_string(length) + " is beyond the binary chunk of " + std::to_string(range.length) +
               " bytes");
  } else if (const std::string uri = buffer["uri"].get<std::string>(); uri.starts_with("data:")) {
    buffer["uri"] = checked_data_uri(uri, length, path, place + ".uri");
    gated.buffers.push_back(range);
    return;
  } else {
    range.path = resolved(uri, path, place + ".uri");
    require_file(range.path, path, place + ".uri");
    const ByteFile file(range.path);
    if (file.size() > options.max_file_bytes)
      fail(range.path, "size",
           std::to_string(file.size()) + " bytes; the limit is " + std::to_string(options.max_file_bytes));
    if (length > file.size())
      fail(path, place,
           "byteLength " + std::to_string(length) + " is beyond " + range.path + " of " + std::to_string(file.size()) +
               " bytes");
  }
  range.length = length;
  buffer["uri"] = buffer_name(index);
  if (std::find(gated.files.begin(), gated.files.end(), range.path) == gated.files.end())
    gated.files.push_back(range.path);
  gated.byte_count += length;
  gated.buffers.push_back(range);
}

GatedImage approve_image(const Json& image, std::size_t index, const std::string& path) {
  GatedImage approved;
  approved.name = image.value("name", "");
  const std::string place = place_of("images", index) + ".uri";
  const std::string uri = image.value("uri", "");
  if (image.contains("bufferView")) {
    approved.buffer_view = image["bufferView"].get<int>();
  } else if (!image.contains("uri")) {
    approved.refused = "has neither uri nor bufferView";
  } else if (uri.starts_with("data:")) {
    if (const auto coded = base64_of(uri)) approved.base64 = *coded;
    else approved.refused = "a data URI must be base64";
  } else if (has_scheme(uri)) {
    approved.refused =
        "\"" + uri.substr(0, 80) + "\" is not a relative path; fetch the file and name it by a relative path";
  } else {
    approved.path = resolved(uri, path, place);
  }
  return approved;
}

/// Limits the total size: many buffers that name one file would make a small scene large.
void check_total(const std::string& path, const GltfOptions& options, const Gated& gated) {
  std::uint64_t on_disk = 0, wanted = 0;
  for (const std::string& file : gated.files) on_disk += ByteFile(file).size();
  for (const ByteRange& range : gated.buffers) wanted += range.length;
  if (wanted > options.max_file_bytes || wanted > 2 * on_disk + (1u << 20))
    fail(path, "buffers",
         std::to_string(wanted) + " bytes in total, more than can be right for files of " + std::to_string(on_disk) +
             " bytes");
}

}  // namespace

std::string buffer_name(std::size_t index) { return "buffer-" + std::to_string(index); }

Gated pass_gate(const std::string& path, const GltfOptions& options) {
  Container container = open_container(path, options);
  Json document = parse_json(container.json, path);
  Gated gated;
  gated.files.push_back(path);
  gated.byte_count = container.json.size();
  container.json = {};
  LeftOut left_out;
  check_types(document, path, left_out);
  check_version(document, path);
  keep_node_extras(document, gated);
  keep_light_extras(document, gated);
  keep_lens_shifts(document, path, gated);
  check_extensions(document, path, gated);
  leave_out_nulls(document, left_out);
  mend_cameras(document, left_out);
  mend_lights(document, left_out);
  for (std::string& warning : left_out.warnings(path)) gated.warnings.push_back(std::move(warning));
  keep_pointer_channels(document, gated);
  mark_stand_ins(document, container.bin.length > 0);
  if (document.contains("buffers"))
    for (std::size_t i = 0; i < document["buffers"].size(); ++i)
      approve_buffer(document["buffers"][i], i, path, container, options, gated);
  check_total(path, options, gated);
  unpack_packed(document, path, options, gated);
  for (std::size_t i = 0; i < array_of(document, "images").size(); ++i)
    gated.images.push_back(approve_image(document["images"][i], i, path));
  document.erase("images");
  gated.json = document.dump();
  return gated;
}

std::vector<unsigned char> read_range(const ByteRange& range) {
  std::vector<unsigned char> bytes(range.length);
  ByteFile(range.path).read_at(range.offset, bytes.data(), range.length);
  return bytes;
}

void require_file(const std::string& named, const std::string& path, const std::string& place) {
  if (::access(named.c_str(), F_OK) != 0)
    fail(path, place,
         named + " cannot be opened: " + std::strerror(errno) +
             "; copy all files of the scene, or export it as one .glb");
}

std::vector<unsigned char> read_whole(const std::string& path, std::uint64_t max_bytes) {
  const ByteFile file(path);
  if (file.size() > max_bytes)
    fail(path, "size", std::to_string(file.size()) + " bytes; the limit is " + std::to_string(max_bytes));
  std::vector<unsigned char> bytes(file.size());
  file.read_at(0, bytes.data(), bytes.size());
  return bytes;
}

}  // namespace tempolux::gltf
