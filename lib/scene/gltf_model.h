// lib/scene/gltf_model.h -- declarations that the gltf_*.cpp files share; the only place that includes tinygltf.
#pragma once

#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lib/scene/gltf_load.h"
#include "lib/scene/gltf_place.h"
#include "lib/scene/scene.h"

namespace tempolux::gltf {

struct Gated;  // gltf_gate.h

/// State of importing one scene from tinygltf's model.
struct Import {
  const tinygltf::Model& model;
  Scene& scene;
  const Gated* gated = nullptr;
  const GltfOptions* options = nullptr;
  std::uint64_t geometry_budget = 0;               ///< bytes that may still be allocated for geometry
  std::vector<int> node_from_source{};             ///< node index of the file -> of the scene, -1: not in the scene
  std::vector<int> mesh_from_source{};             ///< the same for meshes; -1: not used or without triangles
  std::vector<EncodedImage> images{};              ///< of the scene, as they are met
  std::vector<std::uint32_t> image_from_source{};  ///< image of the file -> of the scene, kNone: not read
  struct Mended {
    std::string first_place;
    std::size_t count = 0, places = 0;
  };
  std::map<std::string, Mended> mended{};   ///< what was wrong and what became of it; warnings at the end
  std::map<std::string, Mended> ignored{};  ///< what was ignored, and where first if that helps; warnings at the end

  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    gltf::fail(scene.path, place, what);
  }
  /// Takes `bytes` from the budget before they are allocated; fails if a file asks for far more memory than its size
  /// can explain.
  void take_memory(std::uint64_t bytes, const std::string& place);
  /// Lists something that is ignored. `place` is where the user finds it, as 'materials[3] "Oak"'; "" if a place
  /// would not help.
  void ignore(const std::string& what, std::size_t count = 1, const std::string& place = "") {
    Mended& of = ignored[what];
    if (of.count == 0) of.first_place = place;
    of.count += count;
  }
  /// Lists something that was repaired. `what` names the things in the plural and what was done, as "weights below 0
  /// are left out"; `count` of them are at `place`.
  void mend(const std::string& place, const std::string& what, std::size_t count);
};

/// Normalises a quaternion x y z w; false if it is zero or not finite.
bool normalize_rotation(std::array<double, 4>& rotation);

/// A material's reference to a texture; index -1 for none.
struct TextureUse {
  int index = -1, uv_set = 0;
  const tinygltf::Value* transform = nullptr;  ///< KHR_texture_transform
};
/// gltf_texture.cpp. Reads the image's bytes and size at its first use; refuses images that cannot be decoded.
Texture read_texture(Import& import, const TextureUse& use, const std::string& place);
/// The same from a textureInfo inside an extension.
Texture read_texture(Import& import, const tinygltf::Value& info, const std::string& place);

/// Number of morph targets of a mesh; glTF requires the same number for all its primitives.
std::size_t target_count(const tinygltf::Mesh& mesh);

// The steps of load_gltf, in this order.
void import_nodes(Import& import);        ///< gltf_nodes.cpp: the default scene's nodes, parents first
void import_materials(Import& import);    ///< gltf_material.cpp
void import_lights(Import& import);       ///< gltf_material.cpp: KHR_lights_punctual
void import_cameras(Import& import);      ///< gltf_material.cpp
void import_meshes(Import& import);       ///< gltf_geometry.cpp: the meshes that nodes use
void import_deformation(Import& import);  ///< gltf_deform.cpp: skins, morph weights, instances of nodes
/// gltf_animation.cpp. `only`: the animation of this name (an unnamed one is "animation INDEX"); empty: all animations.
/// Invalid channels are left out with a warning: the property then stays at rest.
void import_animations(Import& import, const std::string& only);

}  // namespace tempolux::gltf
