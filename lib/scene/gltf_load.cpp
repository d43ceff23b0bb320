// lib/scene/gltf_load.cpp -- loads a glTF file with tinygltf.
#include "lib/scene/gltf_load.h"

#include <algorithm>
#include <exception>
#include <new>

#include "formats/error.h"
#include "lib/scene/camera_extras.h"
#include "lib/scene/gltf_check.h"
#include "lib/scene/gltf_gate.h"
#include "lib/scene/gltf_place.h"
#include "lib/scene/lamp_size.h"
#include "lib/scene/place_surfaces.h"

namespace tempolux {
namespace gltf {

void fail(const std::string& file, const std::string& place, const std::string& what) {
  throw InputError(file + ": " + place + ": " + what);
}

std::string one_line(std::string text, std::size_t length) {
  text = text.substr(0, std::min(length, text.find('\n')));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return text;
}

std::string place_of(const char* array, std::size_t index, const std::string& name) {
  const std::string place = std::string(array) + "[" + std::to_string(index) + "]";
  return name.empty() ? place : place + " \"" + one_line(name, 60) + "\"";
}

namespace {

// File callbacks for tinygltf. It can only ask for names of buffers that passed the gate.

const ByteRange* range_named(const std::string& name, void* gated) {
  const std::vector<ByteRange>& buffers = static_cast<const Gated*>(gated)->buffers;
  for (std::size_t i = 0; i < buffers.size(); ++i)
    if (name == buffer_name(i)) return &buffers[i];
  return nullptr;
}

bool buffer_exists(const std::string& name, void* gated) { return range_named(name, gated) != nullptr; }

std::string same_name(const std::string& name, void*) { return name; }

bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string& name, void* gated) {
  const ByteRange* range = range_named(name, gated);
  if (range && range->path.empty()) *out = std::move(static_cast<Gated*>(gated)->unpacked);  // each buffer is read once
  else if (range) *out = read_range(*range);
  return range != nullptr;
}

bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

/// tinygltf wants an image loader, but never gets an image.
bool decode_nothing(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                    void*) {
  return true;
}

tinygltf::Model parse(const std::string& path, Gated& gated) {
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(decode_nothing, nullptr);
  parser.SetFsCallbacks({buffer_exists, same_name, read_buffer, write_nothing, &gated});
  tinygltf::Model model;
  std::string error, warning;
  if (!parser.LoadASCIIFromString(&model, &error, &warning, gated.json.data(), unsigned(gated.json.size()), ""))
    fail(path, "glTF", error.empty() ? "cannot be read" : one_line(error, 200));
  return model;
}

/// Largest ratio of geometry in memory to the files' size: 8-bit indices and positions grow twelvefold. Files may
/// always use kSmallScene bytes.
constexpr std::uint64_t kGrowth = 32, kSmallScene = 64u << 20;

Scene import_scene(const std::string& path, const GltfOptions& options) {
  Gated gated = pass_gate(path, options);
  const tinygltf::Model model = parse(path, gated);
  Scene scene;
  scene.path = path;
  scene.generator = model.asset.generator;
  scene.files = gated.files;
  scene.warnings = gated.warnings;
  Import import{model, scene, &gated, &options, kGrowth * gated.byte_count + kSmallScene};
  check_accessors(import);
  import_nodes(import);
  leave_out_hidden(import, options.animation);
  for (auto& [source, extras] : gated.node_extras)
    if (const int node = import.node_from_source[source]; node >= 0)
      scene.nodes[std::size_t(node)].extras = std::move(extras);
  import_materials(import);
  if (!import.images.empty())
    scene.images = std::make_shared<const TextureImages>(std::move(import.images), options.textures);
  import_lights(import);
  import_cameras(import);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (Node& node = scene.nodes[n]; node.camera >= 0 && !node.extras.empty())
      node.camera_extras = read_camera_extras(node.extras, node_place(scene, n), scene.warnings);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (Node& node = scene.nodes[n]; node.light >= 0 && !node.extras.empty())
      node.lamp_size =
          read_lamp_size(node.extras, scene.lights[std::size_t(node.light)].kind, node_place(scene, n), scene.warnings);
  import_meshes(import);
  import_deformation(import);
  import_animations(import, options.animation);
  for (const auto& [what, ignored] : import.ignored)
    scene.warnings.push_back(path + ": ignored: " + what +
                             (ignored.count > 1 ? ", " + std::to_string(ignored.count) + " times" : "") +
                             (ignored.first_place.empty() ? "" : ", first in " + ignored.first_place));
  for (const auto& [what, mended] : import.mended)
    scene.warnings.push_back(path + ": " + mended.first_place +
                             (mended.places > 1 ? " and " + std::to_string(mended.places - 1) + " more" : "") + ": " +
                             what + (mended.count > 1 ? " (" + std::to_string(mended.count) + ")" : ""));
  return scene;
}

}  // namespace
}  // namespace gltf

Scene load_gltf(const std::string& path, const GltfOptions& options) {
  try {
    return gltf::import_scene(path, options);
  } catch (const InputError&) { throw; } catch (const ResourceError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw ResourceError(path + ": not enough memory to load the scene");
  } catch (const std::exception& error) {
    throw InputError(path + ": cannot be read: " + gltf::one_line(error.what(), 200));
  }
}

}  // namespace tempolux
