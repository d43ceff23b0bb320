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
  std::uint64_t geometry_budget = 0;             ///< bytes that may still be allocated for geometry
  std::vector<int> node_from_source{};           ///< index in the scene of each node of the file; -1: not in the scene
  std::vector<int> mesh_from_source{};           ///< likewise for meshes; -1: not used or without triangles
  std::vector<ColorFactors> emission_factors{};  ///< of each material of the scene
  /// Of each material of the file: the sets TEXCOORD_n that its primitives keep. kNone: none.
  std::vector<std::array<std::uint32_t, 2>> uv_sets{};
  std::vector<EncodedImage> images{};              ///< images of the scene, in the order in which textures name them
  std::vector<std::uint32_t> image_from_source{};  ///< index in `images` of each image of the file; kNone: not read
  /// Counts one kind of repair or ignored feature.
  struct Mended {
    std::string first_place;
    std::size_t count = 0, places = 0;
  };
  std::map<std::string, Mended> mended{};   ///< by the text of mend(); each becomes a warning
  std::map<std::string, Mended> ignored{};  ///< by the text of ignore(); each becomes a warning

  /// Throws InputError "FILE: PLACE: WHAT".
  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    gltf::fail(scene.path, place, what);
  }
  /// Subtracts `bytes` from the budget before they are allocated. Fails if the file needs far more memory than its size
  /// can explain.
  void take_memory(std::uint64_t bytes, const std::string& place);
  /// Notes a feature that is ignored. `place` helps the user to find it, as 'materials[3] "Oak"'; "": no place.
  void ignore(const std::string& what, std::size_t count = 1, const std::string& place = "") {
    Mended& of = ignored[what];
    if (of.count == 0) of.first_place = place;
    of.count += count;
  }
  /// Notes `count` repairs at `place`. `what` names the invalid values in the plural and what was done: "weights below
  /// 0 are left out".
  void mend(const std::string& place, const std::string& what, std::size_t count);
};

/// Normalises a quaternion x y z w; false if it is zero or not finite.
bool normalize_rotation(std::array<double, 4>& rotation);

/// Reads numbers inside the JSON object of an extension.
struct ExtensionReader {
  Import& import;
  const tinygltf::Value& object;
  std::string place;  ///< of the object in the file, for messages

  /// Reads a finite number. Returns `fallback` if the key is missing. Any other value gets a warning and gives
  /// `fallback`.
  double number(const char* key, double fallback) const;
  /// Reads an array of `count` finite numbers. Returns an empty array if the key is missing. Any other value gets a
  /// warning and gives an empty array.
  std::vector<double> numbers(const char* key, std::size_t count) const;
};

/// A material's reference to a texture; index -1 for none.
struct TextureUse {
  int index = -1, uv_set = 0;
  const tinygltf::Value* transform = nullptr;  ///< KHR_texture_transform
};
/// Reads a reference to a texture, and the bytes and size of its image at the image's first use. An empty Texture if
/// the index is -1. Throws InputError for an image that cannot be decoded.
Texture read_texture(Import& import, const TextureUse& use, const std::string& place);
/// Reads a reference to a texture from a textureInfo inside an extension.
Texture read_texture(Import& import, const tinygltf::Value& info, const std::string& place);

/// Reads KHR_materials_pbrSpecularGlossiness, if the material has it, over its metallic-roughness properties and
/// textures (gltf_specular_glossiness.cpp), with a warning that says what is approximated.
void read_specular_glossiness(Import& import, const tinygltf::Material& source, const std::string& place,
                              Material& material, MaterialTextures& textures);

/// True if the animation plays: if it is named `only`, or `only` is empty (GltfOptions::animation).
bool is_played(const tinygltf::Model& model, std::size_t animation, const std::string& only);

/// Number of morph targets of a mesh; glTF requires the same number for all its primitives.
std::size_t target_count(const tinygltf::Mesh& mesh);

// The steps of load_gltf, in this order.
void import_nodes(Import& import);  ///< gltf_nodes.cpp: the default scene's nodes, parents first
/// gltf_nodes.cpp: leaves out meshes and lights of nodes that no frame shows (KHR_node_visibility).
void leave_out_hidden(Import& import, const std::string& only);
void import_materials(Import& import);    ///< gltf_material.cpp
void import_lights(Import& import);       ///< gltf_material.cpp: KHR_lights_punctual
void import_cameras(Import& import);      ///< gltf_material.cpp
void import_meshes(Import& import);       ///< gltf_geometry.cpp: the meshes that nodes use
void import_deformation(Import& import);  ///< gltf_deform.cpp: skins, morph weights, instances of nodes
/// gltf_animation.cpp: the animation named `only` (an unnamed one is called "animation INDEX"), or all if `only` is
/// empty. Invalid channels are dropped with a warning; with `only` they throw InputError.
void import_animations(Import& import, const std::string& only);

}  // namespace tempolux::gltf
