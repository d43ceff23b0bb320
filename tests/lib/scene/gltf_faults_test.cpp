// tests/lib/scene/gltf_faults_test.cpp -- small faults of files: each is replaced or left out with one warning.
// Seen to fail: every case was refused, or said nothing, before the fault was mended.
#include <functional>

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// A lit, textured square with a camera.
GltfMaker good_scene() {
  GltfMaker maker;
  maker.json["images"] = {{{"uri",
                            "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9Q"
                            "DwADhgGAWjR9awAAAABJRU5ErkJggg=="}}};
  maker.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 10497}, {"magFilter", 9728}}};
  maker.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  maker.add_material({{"name", "Oak"},
                      {"alphaMode", "OPAQUE"},
                      {"doubleSided", true},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {0.5, 0.25, 1, 1}},
                        {"metallicFactor", 0.5},
                        {"baseColorTexture", {{"index", 0}, {"texCoord", 0}}}}}});
  const int mesh = maker.add_square(0);
  maker.json["meshes"][std::size_t(mesh)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      maker.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
  maker.add_node({{"name", "Wall"}, {"mesh", mesh}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, 0, 1}}});
  maker.add_light({{"name", "Sun"}, {"type", "directional"}, {"intensity", 3}});
  maker.add_camera();
  return maker;
}

struct Fault {
  const char* place;         ///< JSON pointer
  Json value;                ///< that is put there
  const char *names, *done;  ///< what the warning names and says
  const char* other = "";    ///< a second value, at `other`
  Json other_value = nullptr;
};

const char* const kSpot = "/extensions/KHR_lights_punctual/lights/0/";

std::vector<Fault> faults() {
  const std::string primitive = "/meshes/0/primitives/0/", pbr = "/materials/0/pbrMetallicRoughness/";
  return {
      {"/samplers/0/wrapS", 1234, "samplers[0].wrapS", "1234 is not one of glTF's; the texture repeats"},
      {"/samplers/0/magFilter", 5, "samplers[0].magFilter", "filter 5"},
      {"/samplers/0/wrapT", "no", "samplers[0].wrapT", "\"no\" is left out: must be a whole number"},
      {"/textures/0/sampler", 9, "textures[0].sampler", "sampler 9 does not exist"},
      {"/textures/0/source", 9, "textures[0].source", "image 9 does not exist; the texture is left out"},
      {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", 9, "baseColorTexture.index",
       "texture 9 does not exist"},
      {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", nullptr, "materials[0] \"Oak\"", "is left out"},
      {"/materials/0/pbrMetallicRoughness/baseColorFactor", {0.5, 0.5}, "materials[0] \"Oak\"", "2 numbers where 4"},
      {"/materials/0/pbrMetallicRoughness/baseColorFactor", {0.5, 0.5, 0.5}, "materials[0] \"Oak\"", "alpha 1"},
      {"/materials/0/pbrMetallicRoughness/metallicFactor", "x", "metallicFactor",
       "\"x\" is left out: must be a number"},
      {"/materials/0/alphaMode", "GLASS", "materials[0] \"Oak\".alphaMode", "counts as OPAQUE"},
      {"/materials/0/extensions/KHR_materials_iridescence", nullptr, "KHR_materials_iridescence", "null is left out"},
      {"/materials/0/extensions/KHR_materials_iridescence",
       {{"iridescenceIor", "x"}},
       "iridescenceIor",
       "what is not a number is left out"},
      {"/materials/0/extensions/KHR_materials_iridescence",
       {{"iridescenceFactor", 2}},
       "materials[0] \"Oak\".extensions.KHR_materials_iridescence.iridescenceFactor",
       "2.000000 brought into its range"},
      {"/materials/0/extensions/KHR_materials_iridescence",
       {{"iridescenceThicknessMaximum", -5}},
       "iridescenceThicknessMaximum",
       "brought into its range"},
      {"/materials/0/extensions/KHR_materials_dispersion",
       {{"dispersion", -1}},
       "dispersion",
       "brought into its range"},
      {"/materials/0/extensions/KHR_materials_dispersion", {{"dispersion", nullptr}}, "dispersion", "null is left out"},
      {"/materials/0/doubleSided", 1, "materials[0] \"Oak\".doubleSided", "1 is left out: must be true or false"},
      {"/nodes/0/translation",
       {1, "2", 3},
       "nodes[0] \"Wall\".translation",
       "is left out: must be an array of numbers"},
      {"/nodes/0/translation", {1, 2}, "nodes[0] \"Wall\".translation", "three finite numbers"},
      {"/nodes/0/rotation", {0, 0, 0, 0}, "nodes[0] \"Wall\".rotation", "not a quaternion"},
      {"/nodes/0/rotation", {0, 0, 0, 5}, "nodes[0] \"Wall\".rotation", "normalised"},
      {"/nodes/0/matrix", {1, 2}, "nodes[0] \"Wall\".matrix", "16 finite numbers"},
      {"/nodes/0/camera", 7, "nodes[0] \"Wall\".camera", "index 7 does not exist"},
      {"/nodes/0/extensions", nullptr, "nodes[0] \"Wall\".extensions", "null is left out"},
      {"/nodes/0/extensions/KHR_lights_punctual", nullptr, "KHR_lights_punctual", "null is left out"},
      {"/nodes/1/extensions/KHR_lights_punctual/light", "one", "nodes[1]", "not the index of a light"},
      {"/nodes/0/children", {99}, "nodes", "node 99"},
      {"/scene", 4, "scene", "the first one is rendered"},
      {"/extensions/KHR_lights_punctual/lights/0/spot", nullptr, "lights[0] \"Sun\".spot", "null is left out"},
      {"/extensions/KHR_lights_punctual/lights/0/type", "area", "lights[0] \"Sun\"", "is left out: type must be"},
      {"/extensions/KHR_lights_punctual/lights/0/type", "spot", "lights[0] \"Sun\".spot", "is missing"},
      {"/extensions/KHR_lights_punctual/lights/0/color", {1, 2}, "lights[0] \"Sun\"", "fewer than 3 numbers"},
      {"/extensions/KHR_lights_punctual/lights/0/intensity", -1, "lights[0] \"Sun\"", "brought into its range"},
      {"/cameras/0/type", "fisheye", "cameras[0].type", "perspective is taken"},
      {"/cameras/0/perspective/yfov", 0, "cameras[0].perspective.yfov", "0.8 is taken"},
      {"/cameras/0/perspective", nullptr, "cameras[0].perspective", "null is left out"},
      {"/meshes/0/primitives/0/material", 9, "primitives[0].material", "default material"},
      {"/meshes/0/primitives/0/attributes/TEXCOORD_0", nullptr, "TEXCOORD_0", "null is left out"},
      {"/meshes/0/primitives/0/attributes/COLOR_0", 4, "COLOR_0", "left out"},
  };
}

TEST(GltfFaults, OneFaultIsOneWarningAndTheRestIsRendered) {
  for (const Fault& fault : faults()) {
    GltfMaker maker = good_scene();
    if (std::string(fault.place).ends_with("COLOR_0")) maker.add_vec4({1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1});
    const std::size_t colours = maker.json["accessors"].size() - 1;
    maker.json[Json::json_pointer(fault.place)] = fault.value;
    if (std::string(fault.place).ends_with("COLOR_0")) maker.json[Json::json_pointer(fault.place)] = colours;
    Scene scene;
    ASSERT_NO_THROW(scene = maker.load()) << fault.place;
    ASSERT_GE(scene.warnings.size(), 1u) << fault.place << " " << fault.value;
    EXPECT_TRUE(has_warning(scene, fault.names) && has_warning(scene, fault.done))
        << fault.place << ": " << scene.warnings[0];
    EXPECT_EQ(scene.meshes.size(), 1u) << fault.place;
    EXPECT_NO_THROW(scene_at_frame(scene, segment_of(scene, 0, {}), 0, {})) << fault.place;
  }
  EXPECT_TRUE(good_scene().load().warnings.empty());
}

TEST(GltfFaults, EqualFaultsAreOneWarningWithTheirNumber) {
  GltfMaker maker = good_scene();
  for (int i = 0; i < 4; ++i) maker.add_node({{"mesh", 0}, {"scale", "big"}});
  const Scene scene = maker.load();
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], "nodes[3].scale and 3 more: \"big\" is left out");
}

TEST(GltfFaults, WhatWouldChangeTheMeaningOfOtherDataIsRefused) {
  for (const auto& [place, names] : {std::pair{"/accessors/0/byteOffset", "accessors[0].byteOffset"},
                                     {"/bufferViews/0/byteStride", "bufferViews[0].byteStride"},
                                     {"/accessors/0/sparse", "accessors[0].sparse"}}) {
    GltfMaker maker = good_scene();
    maker.json[Json::json_pointer(place)] = "x";
    EXPECT_CONTAINS(load_error(write_file("decisive.gltf", maker.text())), names);
  }
}

// Seen to fail: 0 in place of the default.
TEST(GltfFaults, ANumberOfAnExtensionThatIsNoneKeepsTheDefault) {
  GltfMaker maker = good_scene();
  maker.json["materials"][0]["extensions"] = {
      {"KHR_materials_iridescence", {{"iridescenceIor", "x"}, {"iridescenceThicknessMaximum", {1, 2}}}},
      {"KHR_materials_dispersion", {{"dispersion", true}}}};
  const Scene scene = maker.load();
  EXPECT_EQ(scene.materials[0].iridescence_ior, Material{}.iridescence_ior);
  EXPECT_EQ(scene.materials[0].iridescence_thickness_maximum, Material{}.iridescence_thickness_maximum);
  EXPECT_EQ(scene.materials[0].dispersion, 0);
}

TEST(GltfFaults, ASpotOfASunIsNoMatter) {
  GltfMaker maker = good_scene();
  maker.json[Json::json_pointer(std::string(kSpot) + "spot")] = nullptr;
  const Scene scene = maker.load();
  EXPECT_EQ(scene.lights[0].kind, PunctualLight::Kind::directional);
  EXPECT_EQ(scene.lights[0].intensity, Rgb(3.0f));
}

TEST(GltfFaults, RequiredExtensionsThatChangeLittleAreLeftOut) {
  for (const auto& [name, says] : {std::pair{"KHR_materials_variants", "the default variant is rendered"},
                                   {"KHR_materials_volume_scatter", "the rest of its materials is rendered"}}) {
    GltfMaker maker = good_scene();
    maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {name};
    const Scene scene = maker.load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_CONTAINS(scene.warnings[0], std::string(name) + " is left out: " + says);
  }
}

// ---- specular-glossiness --------------------------------------------------------------------------------

Json specular_glossiness(const Json& properties) {
  return {{"name", "Brass"}, {"extensions", {{"KHR_materials_pbrSpecularGlossiness", properties}}}};
}

TEST(SpecularGlossiness, FactorsBecomeAlbedoF0AndRoughness) {
  GltfMaker maker = good_scene();
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
  maker.json["materials"][0] = specular_glossiness({{"diffuseFactor", {0.25, 0.5, 0.125, 0.75}},
                                                    {"specularFactor", {0.5, 0.25, 0.0625}},
                                                    {"glossinessFactor", 0.75}});
  maker.json["materials"][0]["alphaMode"] = "BLEND";
  const Scene scene = maker.load();
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], "materials[0] \"Brass\"");
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color, (Rgb{0.25f, 0.5f, 0.125f}));
  EXPECT_EQ(m.alpha, 0.75f);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 0.25f);
  // F0 = ((ior - 1) / (ior + 1))^2 specular_color specular, and the first factor is 1 for ior 0.
  EXPECT_EQ(m.ior, 0);
  EXPECT_EQ(m.specular, 1);
  EXPECT_EQ(m.specular_color, (Rgb{0.5f, 0.25f, 0.0625f}));
}

TEST(SpecularGlossiness, ADiffuseTextureAloneMultipliesTheAlbedo) {
  GltfMaker maker = good_scene();
  maker.json["materials"][0] = specular_glossiness({{"diffuseTexture", {{"index", 0}}}, {"specularFactor", {0, 0, 0}}});
  const Scene scene = maker.load();
  ASSERT_TRUE(scene.materials[0].textures);
  EXPECT_EQ(scene.materials[0].textures->base_color.image, 0u);
  EXPECT_FALSE(scene.materials[0].textures->metallic_roughness);
}

TEST(SpecularGlossiness, ASpecularTextureGivesTexturesOfMetallicRoughness) {
  GltfMaker maker = good_scene();
  maker.json["materials"][0] = specular_glossiness(
      {{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 0}}}, {"glossinessFactor", 0.5}});
  const Scene scene = maker.load();
  const Material& m = scene.materials[0];
  ASSERT_TRUE(m.textures);
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 1);
  EXPECT_NE(m.textures->base_color.image, m.textures->metallic_roughness.image);
  EXPECT_EQ(m.textures->base_color.wrap_u, Texture::Wrap::clamp);
  EXPECT_TRUE(has_warning(scene, "read as metallic-roughness"));
}

TEST(SpecularGlossiness, OtherCoordinatesGiveTheRoughnessOnly) {
  GltfMaker maker = good_scene();
  maker.json["materials"][0] = specular_glossiness(
      {{"diffuseTexture", {{"index", 0}}}, {"specularGlossinessTexture", {{"index", 0}, {"texCoord", 1}}}});
  const Scene scene = maker.load();
  EXPECT_EQ(scene.materials[0].metallic, 0);
  EXPECT_EQ(scene.materials[0].textures->base_color.image, 0u);
  EXPECT_EQ(scene.materials[0].textures->metallic_roughness.uv_set, 1u);
  EXPECT_TRUE(has_warning(scene, "gives the roughness only"));
}

TEST(SpecularGlossiness, WrongValuesHaveTheirDefaults) {
  GltfMaker maker = good_scene();
  maker.json["materials"][0] =
      specular_glossiness({{"diffuseFactor", {1, 2}}, {"specularFactor", "shiny"}, {"glossinessFactor", nullptr}});
  const Scene scene = maker.load();
  EXPECT_EQ(scene.materials[0].base_color, Rgb(1.0f));
  EXPECT_EQ(scene.materials[0].specular_color, Rgb(1.0f));
  EXPECT_EQ(scene.materials[0].roughness, 0);
  EXPECT_GE(scene.warnings.size(), 4u);
}

}  // namespace
}  // namespace tempolux
