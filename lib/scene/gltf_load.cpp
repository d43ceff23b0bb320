// lib/scene/gltf_load.cpp
#include "lib/scene/gltf_load.h"

#include <filesystem>
#include <stdexcept>

#include "formats/error.h"
#include "lib/scene/gltf_check.h"

namespace tempolux {
namespace gltf {

void fail(const std::string& file, const std::string& place, const std::string& what) {
  throw InputError(file + ": " + place + ": " + what);
}

std::string place_of(const char* array, std::size_t index, const std::string& name) {
  const std::string place = std::string(array) + "[" + std::to_string(index) + "]";
  return name.empty() ? place : place + " \"" + name.substr(0, 60) + "\"";
}

}  // namespace gltf

namespace {

/// tinygltf wants to decode images; nothing here needs their pixels.
bool decode_nothing(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                    void*) {
  return true;
}

}  // namespace

Scene load_gltf(const std::string& path, const GltfOptions&) {
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(decode_nothing, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const bool binary = std::filesystem::path(path).extension() == ".glb";
  const bool loaded = binary ? parser.LoadBinaryFromFile(&model, &error, &warning, path)
                             : parser.LoadASCIIFromFile(&model, &error, &warning, path);
  if (!loaded) gltf::fail(path, "glTF", error);

  Scene scene;
  scene.path = path;
  scene.files.push_back(path);
  std::uint64_t bytes = 0;
  for (const tinygltf::Buffer& buffer : model.buffers) bytes += buffer.data.size();
  gltf::Import import{model, scene, 32 * bytes + (64u << 20)};
  gltf::check_accessors(import);
  gltf::import_nodes(import);
  gltf::import_materials(import);
  gltf::import_lights(import);
  gltf::import_cameras(import);
  gltf::import_meshes(import);
  gltf::import_animations(import);
  for (const auto& [what, count] : import.ignored)
    scene.warnings.push_back(path + ": ignored: " + what + (count > 1 ? ", " + std::to_string(count) + " times" : ""));
  return scene;
}

}  // namespace tempolux
