// tests/lib/scene/packed_scene.h -- one small scene, plain and packed in each way that is unpacked.
#pragma once

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/packers.h"

namespace tempolux::test {

/// A square of two triangles, one corner lifted, with normals and texture coordinates.
struct Square {
  std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0.25f, 0, 1, 0};
  std::vector<float> normals{0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1};
  std::vector<float> uvs{0, 0, 1, 0, 1, 1, 0, 0.5f};
  std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
};

inline std::string raw_bytes(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

/// A bufferView of these bytes; its index.
inline int add_view(GltfMaker& maker, const std::string& bytes) {
  maker.add_accessor<char>({bytes.begin(), bytes.end()}, 5121, "SCALAR", 1);
  Json& accessors = maker.json["accessors"];
  accessors.erase(accessors.size() - 1);
  return int(maker.json["bufferViews"].size()) - 1;
}

inline GltfMaker plain_square() {
  const Square square;
  GltfMaker maker;
  const int position = maker.add_vec3(square.positions), normal = maker.add_vec3(square.normals);
  const int uv = maker.add_accessor<float>(square.uvs, 5126, "VEC2", 2);
  const int indices = maker.add_indices({square.indices.begin(), square.indices.end()});
  maker.add_node(
      {{"mesh", maker.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
                                {"indices", indices}})}});
  return maker;
}

/// The square with accessors that have no bytes, and Draco's.
inline GltfMaker draco_square(int bits = 0) {
  const Square square;
  GltfMaker maker = plain_square();
  maker.bytes.clear();
  maker.json["bufferViews"] = Json::array();
  for (Json& accessor : maker.json["accessors"]) accessor.erase("bufferView");
  using Kind = DracoAttribute::Kind;
  const int view = add_view(
      maker,
      draco_bytes(square.indices,
                  {{Kind::position, 3, square.positions}, {Kind::normal, 3, square.normals}, {Kind::uv, 2, square.uvs}},
                  bits));
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  maker.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  return maker;
}

/// The square as gltfpack writes it: bufferViews in a buffer without bytes, each with its packed part of the other one.
inline GltfMaker meshopt_square(const std::string& name = "EXT_meshopt_compression") {
  const Square square;
  GltfMaker maker = plain_square();
  maker.bytes.clear();
  struct Packed {
    std::string bytes;
    const char* mode;
    std::size_t count, stride;
  };
  const std::vector<Packed> packed{{meshopt_attributes(raw_bytes(square.positions), 12), "ATTRIBUTES", 4, 12},
                                   {meshopt_attributes(raw_bytes(square.normals), 12), "ATTRIBUTES", 4, 12},
                                   {meshopt_attributes(raw_bytes(square.uvs), 8), "ATTRIBUTES", 4, 8},
                                   {meshopt_indices(square.indices), "INDICES", 6, 2}};
  std::size_t unpacked = 0;
  for (std::size_t i = 0; i < packed.size(); ++i) {
    const Packed& p = packed[i];
    maker.json["bufferViews"][i] = {{"buffer", 1},
                                    {"byteOffset", unpacked},
                                    {"byteLength", p.count * p.stride},
                                    {"extensions",
                                     {{name,
                                       {{"buffer", 0},
                                        {"byteOffset", maker.bytes.size()},
                                        {"byteLength", p.bytes.size()},
                                        {"byteStride", p.stride},
                                        {"count", p.count},
                                        {"mode", p.mode}}}}}};
    unpacked += p.count * p.stride;
    maker.bytes += p.bytes;
  }
  maker.json["buffers"] = {{{"byteLength", maker.bytes.size()}, {"uri", "data:a/b;base64," + base64(maker.bytes)}},
                           {{"byteLength", unpacked}, {"extensions", {{name, {{"fallback", true}}}}}}};
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {name};
  return maker;
}

/// The square with an image as its colour that an extension lets textures have.
inline GltfMaker square_with_image(const std::string& extension, const std::string& type, const std::string& image) {
  GltfMaker maker = plain_square();
  const int view = add_view(maker, image);
  maker.json["images"] = {{{"bufferView", view}, {"mimeType", type}}};
  maker.json["textures"] = {{{"extensions", {{extension, {{"source", 0}}}}}}};
  maker.add_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  maker.json["meshes"][0]["primitives"][0]["material"] = 0;
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {extension};
  return maker;
}
inline GltfMaker webp_square(const std::string& webp) {
  return square_with_image("EXT_texture_webp", "image/webp", webp);
}
inline GltfMaker avif_square(const std::string& avif) {
  return square_with_image("EXT_texture_avif", "image/avif", avif);
}

}  // namespace tempolux::test
