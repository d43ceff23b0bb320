// Draco, meshopt, WebP and AVIF: an unpacked scene equals the plain scene; damaged data is refused in one line.
#include "lib/core/unpack.h"
#include "lib/image/texture_images.h"
#include "lib/scene/scene_hash.h"
#include "tests/lib/scene/packed_scene.h"
#include "tests/support/png_bytes.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

using test::avif_square;
using test::draco_square;
using test::meshopt_square;
using test::plain_square;
using test::Square;
using test::webp_square;

SceneHashes hashes_of(const Scene& scene) { return scene_at_frame(scene, segment_of(scene, 0, {}), 0, {}).hashes; }

const Primitive& primitive_of(const Scene& scene) { return scene.meshes.at(0).primitives.at(0); }

/// Four texels of different colours, alpha given.
std::vector<std::uint8_t> texels(int channels, std::uint8_t alpha) {
  std::vector<std::uint8_t> codes;
  for (std::uint8_t i = 0; i < 4; ++i)
    for (int c = 0; c < channels; ++c) codes.push_back(c == 3 ? alpha : std::uint8_t(10 + 60 * i + 5 * c));
  return codes;
}

std::string error_of(const GltfMaker& maker) { return load_error(write_file("packed.gltf", maker.text())); }

TEST(GltfPacked, LosslessPackingsGiveThePlainScene) {
  const Scene plain = plain_square().load();
  const SceneHashes expected = hashes_of(plain);
  for (const GltfMaker& maker : {draco_square(), meshopt_square(), meshopt_square("KHR_meshopt_compression")}) {
    const Scene scene = maker.load();
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(primitive_of(scene).triangles, primitive_of(plain).triangles);
    EXPECT_EQ(hashes_of(scene).static_geometry, expected.static_geometry);
  }
}

// A buffer without bytes need not be marked: all its views are packed. Seen to fail: "has no uri, and there is no
// binary chunk for it".
TEST(GltfPacked, ABufferWithoutBytesNeedsNoMark) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    GltfMaker maker = meshopt_square(name);
    maker.json["buffers"][1].erase("extensions");
    EXPECT_EQ(hashes_of(maker.load()).static_geometry, hashes_of(plain_square().load()).static_geometry);
    maker.json["bufferViews"][0].erase("extensions");  // one view is not packed, so bytes are missing
    EXPECT_CONTAINS(error_of(maker), "buffers[1]");
  }
}

TEST(GltfPacked, AGlbHoldsPackedDataInItsBinaryChunk) {
  const std::string path = write_file("packed.glb", draco_square().glb());
  EXPECT_EQ(hashes_of(load_gltf(path)).static_geometry, hashes_of(plain_square().load()).static_geometry);
}

TEST(GltfPacked, TheUsualDracoMethodKeepsPositionsWithinAQuantum) {
  // 14 bits over the largest extent, 1 m: steps of 1 / 16383 m, so at most half of that. Vertices come in another
  // order: each of ours is looked for.
  const Scene scene = draco_square(14).load();
  const Primitive& primitive = primitive_of(scene);
  const Square square;
  ASSERT_EQ(primitive.positions.size(), 4u);
  ASSERT_EQ(primitive.triangles.size(), 2u);
  for (std::size_t v = 0; v < 4; ++v) {
    double nearest = 1;
    for (const Vec3 p : primitive.positions)
      nearest = std::min(
          nearest,
          double(length(p - Vec3(square.positions[3 * v], square.positions[3 * v + 1], square.positions[3 * v + 2]))));
    EXPECT_LE(nearest, std::sqrt(3) * 0.5 / 16383);
  }
}

TEST(GltfPacked, MeshoptTrianglesMayTurnTheirCorners) {
  GltfMaker maker = meshopt_square();
  const Square square;
  const std::string packed = test::meshopt_triangles(square.indices, 4);
  maker.json["buffers"].push_back({{"byteLength", packed.size()}, {"uri", "data:a/b;base64," + base64(packed)}});
  maker.json["bufferViews"][3]["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 2}, {"byteLength", packed.size()}, {"byteStride", 2}, {"count", 6}, {"mode", "TRIANGLES"}};
  const auto turned = [](std::array<std::uint32_t, 3> t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  const Scene scene = maker.load(), plain = plain_square().load();
  for (std::size_t t = 0; t < 2; ++t)
    EXPECT_EQ(turned(primitive_of(scene).triangles.at(t)), turned(primitive_of(plain).triangles.at(t)));
}

TEST(GltfPacked, OctahedralNormalsAreUnitAndNear) {
  GltfMaker maker = meshopt_square();
  const std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0.6f, 0, -0.8f, 0};
  const std::string packed = test::meshopt_attributes(test::octahedral_elements(normals), 4);
  maker.json["buffers"].push_back({{"byteLength", packed.size()}, {"uri", "data:a/b;base64," + base64(packed)}});
  Json& view = maker.json["bufferViews"][1];
  view["byteLength"] = 16, view["byteStride"] = 4;
  view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 2},          {"byteLength", packed.size()},
                                                   {"byteStride", 4},      {"count", 4},
                                                   {"mode", "ATTRIBUTES"}, {"filter", "OCTAHEDRAL"}};
  maker.json["accessors"][1]["componentType"] = 5120, maker.json["accessors"][1]["normalized"] = true;
  const Scene scene = maker.load();
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3 expected(normals[4 * v], normals[4 * v + 1], normals[4 * v + 2]);
    // 8 bits on the octahedron's plane and 8 bits of each coordinate: two steps of 1/127.
    EXPECT_NEAR_VEC(primitive_of(scene).normals.at(v), expected, 2.0 / 127);
  }
}

TEST(GltfPacked, AvifTexturesAreDecodedWhenTheyAreLookedAt) {
  const std::vector<std::uint8_t> codes = texels(4, 77);
  const Scene scene = avif_square(test::avif_bytes(2, 2, 4, codes)).load();
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.images->size(), 1u);
  EXPECT_EQ(scene.images->encoded(0).width, 2);
  EXPECT_EQ(scene.images->decoded_count(), 0u);
  EXPECT_EQ(decode_image(scene.images->encoded(0), 1000).bytes, codes);
  EXPECT_GT(scene.images->pyramid(0, TextureTransfer::linear).byte_count(), 0u);
}

// The plain image beside is the one that every viewer shows.
TEST(GltfPacked, ATextureWithASourceReadsIt) {
  for (GltfMaker maker : {avif_square("no AVIF"), webp_square("no WebP")}) {
    const int view = test::add_view(maker, test::png_bytes(3, 1, 3, std::vector<std::uint8_t>(9)));
    maker.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
    maker.json["textures"][0]["source"] = 1;
    maker.json.erase("extensionsRequired");
    const Scene scene = maker.load();
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.images->size(), 1u);
    EXPECT_EQ(scene.images->encoded(0).width, 3);
  }
}

TEST(GltfPacked, WebpTexturesAreDecodedWhenTheyAreLookedAt) {
  for (const int channels : {3, 4}) {
    const std::vector<std::uint8_t> codes = texels(channels, 77);
    const Scene scene = webp_square(test::webp_bytes(2, 2, channels, codes)).load();
    ASSERT_EQ(scene.images->size(), 1u);
    EXPECT_EQ(scene.images->encoded(0).width, 2);
    EXPECT_EQ(scene.images->decoded_count(), 0u);
    const CodedPixels pixels = decode_image(scene.images->encoded(0), 1000);
    EXPECT_EQ(pixels.channels, channels);
    EXPECT_EQ(pixels.bytes, codes);
    EXPECT_GT(scene.images->pyramid(0, TextureTransfer::linear).byte_count(), 0u);
    EXPECT_THROW(decode_image(scene.images->encoded(0), 3), InputError);
  }
}

TEST(GltfPacked, DamagedDataIsRefusedWithItsPlaceAndRemedy) {
  GltfMaker draco = draco_square();
  draco.bytes[0] = 'X';
  const std::string message = error_of(draco);
  EXPECT_CONTAINS(message,
                  "packed.gltf: meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: tempolux-decode ");
  EXPECT_CONTAINS(message, "; unpack it with `gltf-transform cp IN.glb OUT.glb`, or export without Compression");
  EXPECT_EQ(message.find('\n'), std::string::npos);

  GltfMaker meshopt = meshopt_square();
  meshopt.json["bufferViews"][2]["extensions"]["EXT_meshopt_compression"]["byteLength"] = 3;  // after two sound ones
  EXPECT_CONTAINS(error_of(meshopt),
                  "bufferViews[2].extensions.EXT_meshopt_compression: tempolux-decode cannot decode");

  const std::string webp = test::webp_bytes(2, 2, 3, texels(3, 0));
  const Scene cut = webp_square(webp.substr(0, webp.size() - 8)).load();
  try {
    decode_image(cut.images->encoded(0), 1000);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_CONTAINS(
        e.what(), "images[0]: tempolux-decode cannot decode it: it is damaged or cut short; convert it to PNG or JPEG");
  }
  EXPECT_CONTAINS(error_of(webp_square(webp.substr(0, 20))), "the WebP is damaged or cut short");
  const std::string avif = test::avif_bytes(2, 2, 3, texels(3, 0));
  EXPECT_CONTAINS(error_of(avif_square(avif.substr(0, 60))), "images[0]: no size in its header; the AVIF is damaged");
  GltfMaker unnamed = avif_square(avif);
  unnamed.json["textures"][0]["extensions"]["EXT_texture_avif"] = Json::object();
  EXPECT_CONTAINS(error_of(unnamed), "textures[0].extensions.EXT_texture_avif.source: is missing");
}

TEST(GltfPacked, WhatTheAccessorsSayMustBeWhatIsPacked) {
  GltfMaker vertices = draco_square();
  for (int i = 0; i < 3; ++i) vertices.json["accessors"][i]["count"] = 5;
  EXPECT_CONTAINS(error_of(vertices), "finds 4 vertices where the accessors have 5");
  GltfMaker unequal = draco_square();
  unequal.json["accessors"][1]["count"] = 5;
  EXPECT_CONTAINS(error_of(unequal), "its accessors have different counts");
  GltfMaker indices = draco_square();
  indices.json["accessors"][3]["count"] = 9;
  EXPECT_CONTAINS(error_of(indices), "finds 2 triangles where the accessor of the indices has 9 indices");
  GltfMaker type = draco_square();
  type.json["accessors"][2]["type"] = "VEC3";
  EXPECT_CONTAINS(error_of(type), "finds 2 numbers per vertex in attribute 2 where the accessor has 3");
  GltfMaker id = draco_square();
  id.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 7;
  EXPECT_CONTAINS(error_of(id), "finds no attribute 7");
  GltfMaker view = draco_square();
  view.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 70;
  EXPECT_CONTAINS(error_of(view), "bufferView 70 does not exist");
  GltfMaker strip = draco_square();
  strip.json["meshes"][0]["primitives"][0]["mode"] = 5;
  EXPECT_CONTAINS(error_of(strip), "something else than a list of triangles");
  GltfMaker filter = meshopt_square("KHR_meshopt_compression");
  filter.json["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["filter"] = "COLOR";
  EXPECT_CONTAINS(error_of(filter), "\"COLOR\" is not supported; unpack it with");
  GltfMaker outside = meshopt_square();
  outside.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteOffset"] = 4'000'000'000;
  EXPECT_CONTAINS(error_of(outside), "lie outside buffer 0");
  GltfMaker missing = meshopt_square();
  missing.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"].erase("mode");
  EXPECT_CONTAINS(error_of(missing), "bufferViews[0].extensions.EXT_meshopt_compression.mode: is missing");
}

TEST(GltfPacked, NoMoreIsUnpackedThanPackedBytesCanMean) {
  GltfMaker maker = draco_square();
  for (int i = 0; i < 3; ++i) maker.json["accessors"][i]["count"] = 100'000'000;
  EXPECT_CONTAINS(error_of(maker), "more than can be right");
  for (int i = 0; i < 3; ++i) maker.json["accessors"][i]["count"] = 4'000'000'000u;
  EXPECT_CONTAINS(error_of(maker), "unpacked: more than");
}

TEST(GltfPacked, APlainCopyBesideIsReadInstead) {
  GltfMaker maker = plain_square();
  maker.json["extensionsUsed"] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression"};
  maker.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  maker.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(hashes_of(scene).static_geometry, hashes_of(plain_square().load()).static_geometry);
}

TEST(GltfPacked, PrimitivesThatShareTheirAccessorsAreUnpackedOnce) {
  GltfMaker maker = draco_square();
  Json& primitives = maker.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const Scene scene = maker.load();
  ASSERT_EQ(scene.meshes.at(0).primitives.size(), 2u);
  EXPECT_EQ(scene.meshes[0].primitives[0].positions, scene.meshes[0].primitives[1].positions);
}

TEST(GltfPacked, DamageAnywhereIsReadOrRefusedByOneLine) {
  // Each byte of the packed data is changed once. Some of the changed values may have any value.
  int refused = 0, read = 0;
  for (const GltfMaker& sound : {draco_square(), draco_square(11), meshopt_square()}) {
    for (std::size_t i = 0; i < sound.bytes.size(); i += 3) {
      GltfMaker maker = sound;
      maker.bytes[i] = char(maker.bytes[i] ^ 0x55);
      if (maker.json.contains("buffers")) maker.json["buffers"][0]["uri"] = "data:a/b;base64," + base64(maker.bytes);
      try {
        maker.load();
        ++read;
      } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 10);
  EXPECT_GT(read, 10);
}

}  // namespace
}  // namespace tempolux
