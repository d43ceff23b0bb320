// Textures as a glTF file names them: images, samplers, transforms, hashes; refused what cannot be used.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/image/texture_images.h"
#include "lib/scene/scene_hash.h"
#include "lib/scene/texture_lookup.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/png_bytes.h"

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
      view.json["accessors"][std::size_t(view.add_accessor<char>({png.begin(), png.end()}, 5121, "SCALAR", 1))]["bufferView"];
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
  bomb[16] = bomb[20] = 0, bomb[17] = bomb[21] = 1;   // 65538 x 65538
  for (const Case& c : {Case{{{"uri", "none.png"}}, "cannot be opened"},
                        Case{{{"uri", "http://example.org/a.png"}}, "not a relative path"},
                        Case{{{"uri", "data:image/png,abc"}}, "must be base64"},
                        Case{{{"uri", "data:image/png;base64,!!!!"}}, "not base64"},
                        Case{{{"name", "x"}}, "neither uri nor bufferView"},
                        Case{{{"bufferView", 77}}, "does not exist"},
                        Case{{{"uri", data_uri("RIFF1234WEBPVP8 ")}}, "is WebP"},
                        Case{{{"uri", data_uri("abc")}}, "neither PNG nor JPEG"},
                        Case{{{"uri", data_uri(bomb)}}, "over the limit"}}) {
    const std::string error = load_error(write_file("bad.gltf", textured(c.image).text()));
    EXPECT_CONTAINS(error, c.part);
  }
  EXPECT_CONTAINS(load_error(write_file("bad.gltf", textured({{"uri", data_uri(png)}}, {{"index", 7}}).text())),
                  "texture 7 does not exist");
  GltfMaker maker = textured({{"uri", data_uri(png)}});
  maker.json["textures"][0]["source"] = 3;
  EXPECT_CONTAINS(load_error(write_file("bad.gltf", maker.text())), "image 3 does not exist");
  maker.json["textures"][0] = {{"source", 0}, {"sampler", 0}};
  EXPECT_CONTAINS(load_error(write_file("bad.gltf", maker.text())), "sampler 0 does not exist");
  maker.json["samplers"] = {{{"wrapS", 1}}};
  EXPECT_CONTAINS(load_error(write_file("bad.gltf", maker.text())), "samplers[0].wrapS");
}

TEST(GltfTexture, SamplersAndTransforms) {
  GltfMaker maker = textured({{"uri", data_uri(small_png())}},
                             {{"index", 0},
                              {"extensions",
                               {{"KHR_texture_transform",
                                 {{"offset", {0.1, 0.2}}, {"rotation", M_PI / 6}, {"scale", {2, 3}}}}}}});
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
  EXPECT_CONTAINS(load_error(write_file("bad.gltf", maker.text())), "is not OPAQUE, MASK or BLEND");
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
