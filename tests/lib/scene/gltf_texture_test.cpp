// Textures as a glTF file names them: images, samplers, transforms, hashes; refused what cannot be used.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/image/texture_images.h"
#include "lib/scene/scene_hash.h"
#include "lib/scene/texture_lookup.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/png_bytes.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// Four texels: code 10 and 20 above, 30 and 40 below, on all three channels.
std::string small_png() { return test::png_bytes(2, 2, 1, {10, 20, 30, 40}); }
std::string data_uri(const std::string& bytes) { return "data:image/png;base64," + base64(bytes); }

/// One square with a material of one base colour texture of the image given.
GltfMaker textured(const Json& image, const Json& info = {{"index", 0}}) {
  GltfMaker maker;
  maker.json["images"] = {image};
  maker.json["textures"] = {{{"source", 0}}};
  maker.add_material({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
  maker.add_node({{"mesh", maker.add_square(0)}});
  maker.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      maker.add_accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, 5126, "VEC2", 2);
  return maker;
}

TEST(GltfTexture, ImagesComeFromDataUrisBufferViewsAndFiles) {
  const std::string png = small_png();
  write_file("t/pic.png", png);
  GltfMaker view = textured({{"bufferView", 0}, {"mimeType", "image/png"}});
  view.json["images"][0]["bufferView"] =
      view.json["accessors"][std::size_t(view.add_accessor<char>({png.begin(), png.end()}, 5121, "SCALAR", 1))]
               ["bufferView"];
  for (const GltfMaker& maker : {textured({{"uri", data_uri(png)}}), textured({{"uri", "pic.png"}}), view}) {
    const Scene scene = maker.load("t/scene.gltf");
    ASSERT_TRUE(scene.images);
    ASSERT_EQ(scene.images->size(), 1u);
    const EncodedImage& image = scene.images->encoded(0);
    EXPECT_EQ(std::string(image.bytes.begin(), image.bytes.end()), png);
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(scene.images->decoded_count(), 0u);
    EXPECT_EQ(scene.materials[0].textures->base_color.image, 0u);
    EXPECT_FALSE(scene.materials[1].textures);
    EXPECT_TRUE(scene.warnings.empty());
  }
  EXPECT_EQ(textured({{"uri", "pic.png"}}).load("t/scene.gltf").files.back(),
            (temporary_folder() / "t/pic.png").string());
}

/// Base colour on TEXCOORD_3, emission on TEXCOORD_1, roughness on TEXCOORD_0: a primitive keeps the first two. Seen to
/// fail: the base colour was left out.
TEST(GltfTexture, MaterialsReadAnyTwoSetsOfCoordinates) {
  GltfMaker maker = textured({{"uri", data_uri(small_png())}}, {{"index", 0}, {"texCoord", 3}});
  maker.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
  maker.json["materials"][0]["emissiveTexture"] = {{"index", 0}, {"texCoord", 1}};
  auto& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
  for (const int set : {1, 3}) {
    const float at = 0.1f * float(set);
    attributes["TEXCOORD_" + std::to_string(set)] =
        maker.add_accessor<float>({at, 1, 1, 1, 1, 0, 0, 0}, 5126, "VEC2", 2);
  }
  const Scene two = maker.load();
  EXPECT_TRUE(two.warnings.empty()) << two.warnings.front();
  EXPECT_EQ(two.materials[0].textures->base_color.uv_set, 0u);
  EXPECT_EQ(two.materials[0].textures->emission.uv_set, 1u);
  const Primitive& square = two.meshes[0].primitives[0];
  EXPECT_FLOAT_EQ(square.uvs[0].x, 0.3f);
  EXPECT_FLOAT_EQ(square.uvs1[0].x, 0.1f);

  maker.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
  const Scene three = maker.load();
  ASSERT_EQ(three.warnings.size(), 1u);
  EXPECT_CONTAINS(three.warnings[0], "textures on a third set of coordinates");
  EXPECT_EQ(three.materials[0].textures->base_color.uv_set, 0u);
  EXPECT_EQ(three.materials[0].textures->metallic_roughness.uv_set, 1u);
  EXPECT_FALSE(three.materials[0].textures->emission);
}

TEST(GltfTexture, ImagesThatNoTextureNamesAreNotRead) {
  GltfMaker maker = textured({{"uri", data_uri(small_png())}});
  maker.json["images"].push_back({{"uri", "there-is-none.png"}});
  maker.json["images"].push_back({{"uri", "http://example.org/a.png"}});
  EXPECT_EQ(maker.load().images->size(), 1u);
}

TEST(GltfTexture, WhatCannotBeUsedIsRefused) {
  struct Case {
    Json image;
    const char* part;
  };
  const std::string png = small_png();
  std::string bomb = png;
  bomb[16] = bomb[20] = 0, bomb[17] = bomb[21] = 1;  // 65538 x 65538
  for (const Case& c :
       {Case{{{"uri", "none.png"}}, "bad.gltf: images[0]: "},
        Case{{{"uri", "none.png"}},
             "none.png cannot be opened: No such file or directory; copy all files of the scene"},
        Case{{{"uri", "http://example.org/a.png"}}, "not a relative path"},
        Case{{{"uri", "data:image/png,abc"}}, "must be base64"},
        Case{{{"uri", "data:image/png;base64,!!!!"}}, "not base64"},
        Case{{{"name", "x"}}, "neither uri nor bufferView"}, Case{{{"bufferView", 77}}, "does not exist"},
        Case{{{"uri", data_uri("RIFF1234WEBPVP8 ")}}, "the WebP is damaged"},
        Case{{{"uri", data_uri("abc")}}, "neither PNG nor JPEG"}, Case{{{"uri", data_uri(bomb)}}, "over the limit"}}) {
    const std::string error = load_error(write_file("bad.gltf", textured(c.image).text()));
    EXPECT_CONTAINS(error, c.part);
  }
}

TEST(GltfTexture, SamplersAndTransforms) {
  GltfMaker maker =
      textured({{"uri", data_uri(small_png())}},
               {{"index", 0},
                {"extensions",
                 {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", M_PI / 6}, {"scale", {2, 3}}}}}}});
  maker.json["textures"][0]["sampler"] = 0;
  maker.json["samplers"] = {{{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}}};
  const Texture texture = maker.load().materials[0].textures->base_color;
  EXPECT_EQ(texture.wrap_u, TextureWrap::mirrored);
  EXPECT_EQ(texture.wrap_v, TextureWrap::clamp);
  EXPECT_TRUE(texture.nearest);
  // offset + R(30 degrees) scale uv; (1, 0) turns towards (0, -1), counter-clockwise with v downwards.
  const double c = std::sqrt(3) / 2, s = 0.5;
  const double expected[6] = {2 * c, 3 * s, 0.1, -2 * s, 3 * c, 0.2};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(texture.transform[std::size_t(i)], expected[i], 1e-6) << i;
}

/// A square whose normal map is constant: red tilts the normal along the image's right, green along its top. The
/// texture coordinates put the right at x = 1 and the top at y = 1; the tangents of the file put the right at y = 1.
GltfMaker with_tangents(bool green, float side, const Json& transform = nullptr) {
  const std::string png = test::png_bytes(
      1, 1, 3, green ? std::vector<std::uint8_t>{128, 218, 218} : std::vector<std::uint8_t>{218, 128, 218});
  GltfMaker maker = textured({{"uri", data_uri(png)}});
  Json info = {{"index", 0}};
  if (!transform.is_null()) info["extensions"]["KHR_texture_transform"] = transform;
  maker.json["materials"][0] = {{"normalTexture", info}};
  Json& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TANGENT"] = maker.add_vec4({0, 1, 0, side, 0, 1, 0, side, 0, 1, 0, side, 0, 1, 0, side});
  return maker;
}

Vec3 bent_normal(const GltfMaker& maker, int frame = 0) {
  const Scene scene = maker.load();
  const SceneFrame at = scene_at_frame(scene, segment_of(scene, frame, {}), frame, {});
  const Texture& map = scene.materials[0].textures->normal;
  return TextureSpot(at, 0, 0, 0.3f, 0.3f, 0).bend(map, 1, {0, 0, 1}, {0, 0, 1});
}

TEST(GltfTexture, NormalMapsFollowTheTangentsOfTheFile) {
  // Codes 218 and 128: 0.7098 and 0.0039. The third axis is normal x tangent times the side: z x y = -x.
  const float s = std::sqrt(0.5f);
  constexpr double kCode = 6e-3;
  EXPECT_NEAR_VEC(bent_normal(with_tangents(false, 1)), (Vec3{0, s, s}), kCode);
  EXPECT_NEAR_VEC(bent_normal(with_tangents(true, 1)), (Vec3{-s, 0, s}), kCode);
  EXPECT_NEAR_VEC(bent_normal(with_tangents(true, -1)), (Vec3{s, 0, s}), kCode);
  // Nodes turn, stretch and mirror them with the surface; normals that are left out take the tangents with them.
  GltfMaker turned = with_tangents(false, 1), mirrored = with_tangents(true, 1), flat = with_tangents(false, 1);
  turned.json["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};  // y to -x
  EXPECT_NEAR_VEC(bent_normal(turned), (Vec3{-s, 0, s}), kCode);
  mirrored.json["nodes"][0]["scale"] = {-3, 1, 1};
  EXPECT_NEAR_VEC(bent_normal(mirrored), (Vec3{s, 0, s}), kCode);
  flat.json["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
  EXPECT_NEAR_VEC(bent_normal(flat), (Vec3{s, 0, s}), kCode);
  // A map that is turned on the surface follows its texture coordinates; a map that is only shifted keeps the file's
  // tangents.
  EXPECT_NEAR_VEC(bent_normal(with_tangents(false, 1, {{"rotation", M_PI / 2}})), (Vec3{0, -s, s}), kCode);
  EXPECT_NEAR_VEC(bent_normal(with_tangents(false, 1, {{"offset", {0.2, 0}}, {"scale", {2, 5}}})), (Vec3{0, s, s}),
                  kCode);
}

TEST(GltfTexture, TangentsFollowMorphTargets) {
  // The target turns the tangent from +y to -x: right is then -x.
  GltfMaker maker = with_tangents(false, 1);
  Json& primitive = maker.json["meshes"][0]["primitives"][0];
  primitive["targets"] = {{{"POSITION", maker.add_vec3(std::vector<float>(12, 0))},
                           {"TANGENT", maker.add_vec3({-1, -1, 0, -1, -1, 0, -1, -1, 0, -1, -1, 0})}}};
  maker.json["meshes"][0]["weights"] = {1};
  const float s = std::sqrt(0.5f);
  EXPECT_NEAR_VEC(bent_normal(maker), (Vec3{-s, 0, s}), 6e-3);
}

TEST(GltfTexture, TangentsAreReadWithANormalMapOnlyAndChecked) {
  EXPECT_EQ(with_tangents(false, 1).load().meshes[0].primitives[0].tangents.size(), 4u);
  GltfMaker plain = with_tangents(false, 1);
  plain.json["materials"][0] = Json::object();
  EXPECT_TRUE(plain.load().meshes[0].primitives[0].tangents.empty());
  GltfMaker few = with_tangents(false, 1), zero = few;
  Json& attributes = few.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TANGENT"] = few.add_vec4({0, 1, 0, 1});
  EXPECT_TRUE(has_warning(few.load(), "TANGENT: 1 tangents for 4 positions are left out"));
  attributes["TANGENT"] = few.add_vec3({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0});
  EXPECT_CONTAINS(load_error(write_file("bad.gltf", few.text())), "TANGENT");
  zero.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = zero.add_vec4(std::vector<float>(16, 0));
  EXPECT_TRUE(has_warning(zero.load(), "tangents of zero length"));
  // Other tangents are another geometry.
  const auto geometry = [](const GltfMaker& maker) {
    const Scene scene = maker.load();
    const SceneFrame at = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
    return geometry_hash(scene, {}, at.surfaces);
  };
  EXPECT_NE(geometry(with_tangents(false, 1)), geometry(with_tangents(false, -1)));
}

TEST(GltfTexture, AlphaModesAndUnlit) {
  GltfMaker maker = textured({{"uri", data_uri(small_png())}});
  maker.json["materials"][0]["alphaMode"] = "MASK";
  maker.json["materials"][0]["alphaCutoff"] = 0.25;
  maker.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.75};
  maker.json["materials"][0]["extensions"]["KHR_materials_unlit"] = Json::object();
  maker.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
  const Material material = maker.load().materials[0];
  EXPECT_EQ(material.alpha_mode, Material::Alpha::mask);
  EXPECT_EQ(material.alpha_cutoff, 0.25f);
  EXPECT_EQ(material.alpha, 0.75f);
  EXPECT_TRUE(material.unlit);
  EXPECT_FALSE(material.emissive());
  maker.json["materials"][0]["alphaMode"] = "GLASS";
  EXPECT_TRUE(has_warning(maker.load(), "is not OPAQUE, MASK or BLEND"));
}

TEST(GltfTexture, TheMaterialsHashKnowsTheBytesAndHowTheyAreLaidOn) {
  const auto hash = [](const GltfMaker& maker) {
    const Scene scene = maker.load();
    return materials_hash(scene, scene.materials);
  };
  const GltfMaker maker = textured({{"uri", data_uri(small_png())}});
  const std::string first = hash(maker);
  GltfMaker other = maker;
  other.json["images"][0]["name"] = "another name";
  EXPECT_EQ(hash(other), first);
  other.json["images"][0]["uri"] = data_uri(test::png_bytes(2, 2, 1, {10, 20, 30, 41}));
  EXPECT_NE(hash(other), first);
  other = maker;
  other.json["samplers"] = {{{"wrapS", 33071}}};
  other.json["textures"][0]["sampler"] = 0;
  EXPECT_NE(hash(other), first);
  other = maker;
  other.json["materials"][0]["alphaMode"] = "BLEND";
  EXPECT_NE(hash(other), first);
}

TEST(GltfTexture, ReadAtAPointOfTheSquare) {
  GltfMaker maker = textured({{"uri", data_uri(small_png())}});
  const Scene scene = maker.load();
  const SceneFrame frame = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
  const Texture texture = scene.materials[0].textures->base_color;
  // Triangle 0 is (0,0) (1,0) (1,1) with coordinates (0,1) (1,1) (1,0): the picture stands upright.
  const auto code_at = [&](float x, float y) {
    return TextureSpot(frame, 0, 0, x - y, y, 0).read(texture, TextureTransfer::linear)[0] * 255;
  };
  EXPECT_NEAR(code_at(0.75f, 0.25f), 40, 1e-3);
  EXPECT_NEAR(code_at(0.75f, 0.75f), 20, 1e-3);
  EXPECT_NEAR(code_at(0.5f, 0.5f), 25, 1e-3);
  EXPECT_NEAR(code_at(0.25f, 0.25f), 30, 1e-3);
  // One square metre of 2 x 2 texels: a footprint of 1 m is level 1, the mean.
  EXPECT_NEAR(TextureSpot(frame, 0, 0, 0.3f, 0.1f, 1).read(texture, TextureTransfer::linear)[0] * 255, 25, 0.51);
}

}  // namespace
}  // namespace tempolux
