// tests/lib/scene/gltf_maker.h -- small glTF files made in the test, and where the shared scenes are.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/error.h"
#include "lib/scene/at_frame.h"
#include "lib/scene/gltf_load.h"

namespace tempolux {

using Json = nlohmann::json;
namespace fs = std::filesystem;

/// A folder of its own for each test program, removed at the end.
inline fs::path temporary_folder() {
  struct Folder {
    fs::path path = fs::temp_directory_path() / ("tempolux-scene-test-" + std::to_string(::getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
  };
  static const Folder folder;
  return folder.path;
}

inline std::string write_file(const std::string& name, const std::string& bytes) {
  const fs::path path = temporary_folder() / name;
  fs::create_directories(path.parent_path());
  fs::remove(path);  // ext4 flushes a file that is truncated and written again: 2 ms each
  std::ofstream(path, std::ios::binary) << bytes;
  return path.string();
}

/// ../shared/scenes of the project, or empty if it is not there.
inline fs::path shared_scenes() {
  for (const char* candidate : {"../../shared/scenes", "../shared/scenes"})
    if (fs::exists(fs::path(candidate) / "made")) return candidate;
  return {};
}

inline std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// Builds a document with one buffer. The members of `json` may be changed freely before writing.
struct GltfMaker {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", Json::array()}}}}};
  std::string bytes;

  template <class T>
  int add_accessor(const std::vector<T>& values, int component_type, const char* type, std::size_t per_element) {
    while (bytes.size() % 4) bytes += '\0';
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", values.size() / per_element},
                                 {"type", type}});
    return int(json["accessors"].size()) - 1;
  }
  int add_vec3(const std::vector<float>& values) { return add_accessor(values, 5126, "VEC3", 3); }
  int add_vec4(const std::vector<float>& values) { return add_accessor(values, 5126, "VEC4", 4); }
  int add_scalars(const std::vector<float>& values) { return add_accessor(values, 5126, "SCALAR", 1); }
  int add_indices(const std::vector<std::uint16_t>& values) { return add_accessor(values, 5123, "SCALAR", 1); }

  int add_material(const Json& material) { return add("materials", material); }
  int add_mesh(const Json& primitive) { return add("meshes", {{"primitives", {primitive}}}); }
  /// The triangle (0,0,0) (1,0,0) (0,1,0), or a unit square with normals along +z.
  int add_triangle(int material = -1) {
    Json primitive = {{"attributes", {{"POSITION", add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}};
    if (material >= 0) primitive["material"] = material;
    return add_mesh(primitive);
  }
  int add_square(int material = -1) {
    Json primitive = {{"attributes",
                       {{"POSITION", add_vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})},
                        {"NORMAL", add_vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})}}},
                      {"indices", add_indices({0, 1, 2, 0, 2, 3})}};
    if (material >= 0) primitive["material"] = material;
    return add_mesh(primitive);
  }
  /// Adds the node to the scene unless it is a child of a later one.
  int add_node(const Json& node, bool root = true) {
    const int index = add("nodes", node);
    if (root) json["scenes"][0]["nodes"].push_back(index);
    return index;
  }
  int add_camera(const Json& node = {{"name", "Camera"}}) {
    Json with = node;
    with["camera"] = add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    return add_node(with);
  }
  int add_light(const Json& light, const Json& node = Json::object()) {
    json["extensions"]["KHR_lights_punctual"]["lights"].push_back(light);
    Json with = node;
    with["extensions"]["KHR_lights_punctual"]["light"] = json["extensions"]["KHR_lights_punctual"]["lights"].size() - 1;
    return add_node(with);
  }
  /// One animated property; values as in the file.
  void animate(int node, const char* path, const std::vector<float>& times, const std::vector<float>& values,
               const char* interpolation = "LINEAR") {
    if (!json.contains("animations")) json["animations"] = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
    Json& animation = json["animations"][0];
    const int output = std::string(path) == "rotation" ? add_vec4(values) : add_vec3(values);
    animation["samplers"].push_back(
        {{"input", add_scalars(times)}, {"output", output}, {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }

  std::string text() const {
    Json out = json;
    if (!bytes.empty() && !out.contains("buffers"))
      out["buffers"] = {
          {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    return out.dump();
  }
  std::string glb() const {
    Json out = json;
    out["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = out.dump(), binary = bytes;
    while (text.size() % 4) text += ' ';
    while (binary.size() % 4) binary += '\0';
    const auto u32 = [](std::size_t value) {
      const auto v = std::uint32_t(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    return "glTF" + u32(2) + u32(28 + text.size() + binary.size()) + u32(text.size()) + "JSON" + text +
           u32(binary.size()) + std::string("BIN\0", 4) + binary;
  }
  Scene load(const std::string& name = "scene.gltf") const { return load_gltf(write_file(name, text())); }

 private:
  int add(const char* array, const Json& value) {
    json[array].push_back(value);
    return int(json[array].size()) - 1;
  }
};

/// The message of the InputError that loading throws; fails the test if there is none.
inline std::string load_error(const std::string& path, const GltfOptions& options = {}) {
  try {
    load_gltf(path, options);
  } catch (const InputError& error) { return error.what(); }
  ADD_FAILURE() << path << " was loaded";
  return {};
}

inline bool has_warning(const Scene& scene, const std::string& part) {
  for (const std::string& warning : scene.warnings)
    if (warning.find(part) != std::string::npos) return true;
  return false;
}

#define EXPECT_CONTAINS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)
#define EXPECT_NEAR_VEC(actual, expected, tolerance) \
  do {                                               \
    const auto a_ = (actual);                        \
    const decltype(a_) e_ = (expected);              \
    EXPECT_NEAR(a_.x, e_.x, tolerance) << "x";       \
    EXPECT_NEAR(a_.y, e_.y, tolerance) << "y";       \
    EXPECT_NEAR(a_.z, e_.z, tolerance) << "z";       \
  } while (false)

}  // namespace tempolux
