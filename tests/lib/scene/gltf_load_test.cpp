// tests/lib/scene/gltf_load_test.cpp -- what a glTF file says, as plain data.
#include <cmath>
#include <limits>
#include <set>

#include "lib/scene/light_units.h"
#include "tests/lib/scene/gltf_maker.h"

namespace tempolux {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::size_t triangle_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Node& node : scene.nodes)
    if (node.mesh >= 0)
      for (const Primitive& primitive : scene.meshes[std::size_t(node.mesh)].primitives)
        count += primitive.triangles.size();
  return count;
}

std::string error_of(const GltfMaker& maker) { return load_error(write_file("bad.gltf", maker.text())); }

TEST(GltfLoad, AllMadeScenesLoadWithTheirTriangles) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const std::map<std::string, std::size_t> triangles{{"S1_cornell.glb", 52},
                                                     {"S2_cornell_moving.glb", 52},
                                                     {"S6_smoke.glb", 52},
                                                     {"U1_point.gltf", 2},
                                                     {"U5_furnace_closed.gltf", 12}};
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(shared_scenes() / "made")) {
    const std::string extension = entry.path().extension();
    if (extension != ".gltf" && extension != ".glb") continue;
    const Scene scene = load_gltf(entry.path().string());
    EXPECT_GE(scene.camera_node("auto"), 0);
    if (const auto known = triangles.find(entry.path().filename()); known != triangles.end()) {
      EXPECT_EQ(triangle_count(scene), known->second) << entry.path();
    }
    const bool only_volume = entry.path().filename().string().starts_with("V");
    if (!only_volume) { EXPECT_NO_THROW(require_lights(scene)) << entry.path(); }
    ++count;
  }
  EXPECT_GE(count, 17);
}

TEST(GltfLoad, FoundFilesLoadOrSayWhatIsNotSupported) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  std::set<std::string> refused;
  int loaded = 0;
  for (const auto& entry : fs::recursive_directory_iterator(shared_scenes() / "found")) {
    const std::string extension = entry.path().extension();
    if (extension != ".gltf" && extension != ".glb") continue;
    try {
      load_gltf(entry.path().string());
      ++loaded;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.find("is not supported; ") != std::string::npos ||
                  message.find("nothing to render") != std::string::npos)
          << message;
      refused.insert(entry.path().filename());
    }
  }
  // Lamps without a mesh. Draco, meshopt, WebP and AVIF are unpacked.
  EXPECT_EQ(refused, std::set<std::string>{"four_spotlights.glb"});
  EXPECT_GE(loaded, 40);
}

TEST(GltfLoad, TheAtriumHasItsGlassAndNothingIsLeftOut) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const Scene scene = load_gltf((shared_scenes() / "made/S4_atrium.glb").string());
  int glass = 0;
  for (const Material& material : scene.materials) {
    if (material.transmission == 0) continue;
    ++glass;
    EXPECT_EQ(material.transmission, 1);
    EXPECT_NEAR(material.ior, 1.52, 1e-6);
    EXPECT_FALSE(material.thin_walled);
  }
  EXPECT_EQ(glass, 1);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfLoad, StripsAndFansBecomeTrianglesWithTheirWinding) {
  GltfMaker maker;
  const int positions = maker.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 1});
  const Json attributes = {{"POSITION", positions}};
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", attributes}, {"mode", 5}})}});
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", attributes}, {"mode", 6}})}});
  const Scene scene = maker.load();
  // glTF 2.0, 3.7.2.1: strip p_i = {v_i, v_(i+1+i%2), v_(i+2-i%2)}, fan p_i = {v_(i+1), v_(i+2), v_0}
  EXPECT_EQ(scene.meshes[0].primitives[0].triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(scene.meshes[1].primitives[0].triangles, (std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
}

TEST(GltfLoad, PointsAndLinesAreIgnoredByName) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  const Scene scene = maker.load();
  EXPECT_EQ(scene.meshes[0].primitives.size(), 1u);
  EXPECT_TRUE(has_warning(scene, "points and lines"));
}

TEST(GltfLoad, QuantizedAttributesBecomeNumbers) {
  GltfMaker maker;
  const int positions =
      maker.add_accessor<std::int16_t>({-32768, -32767, 0, 32767, 0, 0, 0, 16384, 0}, 5122, "VEC3", 3);
  const int normals = maker.add_accessor<std::int8_t>({0, 0, 127, 0, 0, 127, 0, 0, 127}, 5120, "VEC3", 3);
  const int uvs = maker.add_accessor<std::uint8_t>({0, 255, 51, 102, 0, 0}, 5121, "VEC2", 2);
  maker.json["accessors"][positions]["normalized"] = true;
  maker.json["accessors"][normals]["normalized"] = true;
  maker.json["accessors"][uvs]["normalized"] = true;
  maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  maker.add_node({{"mesh", maker.add_mesh({{"attributes",
                                            {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}}})}});
  const Scene scene = maker.load();
  const Primitive& primitive = scene.meshes[0].primitives[0];
  EXPECT_EQ(primitive.positions[0], (Vec3{-1, -1, 0}));  // the lowest integer also means -1
  EXPECT_EQ(primitive.positions[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(primitive.positions[2].y, float(16384 / 32767.0));
  EXPECT_EQ(primitive.normals[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(primitive.uvs[1], (Vec2{float(51 / 255.0), float(102 / 255.0)}));
}

TEST(GltfLoad, IntegersThatAreNotNormalisedKeepTheirValue) {
  GltfMaker maker;
  const int positions = maker.add_accessor<std::uint16_t>({0, 0, 0, 1000, 0, 0, 0, 65535, 0}, 5123, "VEC3", 3);
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
  EXPECT_EQ(maker.load().meshes[0].primitives[0].positions[2], (Vec3{0, 65535, 0}));
}

TEST(GltfLoad, InterleavedVerticesAreReadByTheirStride) {
  GltfMaker maker;
  const int positions = maker.add_vec3({0, 0, 0, 9, 9, 9, 1, 0, 0, 9, 9, 9, 0, 1, 0, 9, 9, 9});
  maker.json["bufferViews"][0]["byteStride"] = 24;
  maker.json["accessors"][0]["count"] = 3;
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
  EXPECT_EQ(maker.load().meshes[0].primitives[0].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(GltfLoad, SparseAccessorsReplaceSomeElements) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  const int indices = maker.add_indices({2}), values = maker.add_vec3({0, 5, 0});
  maker.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", maker.json["accessors"][indices]["bufferView"]}, {"componentType", 5123}}},
      {"values", {{"bufferView", maker.json["accessors"][values]["bufferView"]}}}};
  EXPECT_EQ(maker.load().meshes[0].primitives[0].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 5, 0}}));
  maker.json["accessors"][0].erase("bufferView");  // the rest is then zero
  maker.json["accessors"][0]["count"] = 3;
  EXPECT_CONTAINS(error_of(maker), "no node of the scene has a mesh with triangles");
  maker.bytes.replace(maker.json["bufferViews"][1]["byteOffset"].get<std::size_t>(), 1, 1, char(3));
  EXPECT_CONTAINS(error_of(maker), "sparse index 3 is beyond");
}

TEST(GltfLoad, MissingNormalsMeanFlatShading) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.add_node({{"mesh", maker.add_square()}});
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.meshes[0].primitives[0].normals.empty());
  EXPECT_EQ(scene.meshes[1].primitives[0].normals.size(), 4u);
}

TEST(GltfLoad, NormalsBecomeUnitAndZeroOnesAreMadeFromTheirTriangles) {
  GltfMaker maker;
  const int positions = maker.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int long_ones = maker.add_vec3({0, 0, 3, 0, 3, 0, 3, 0, 0}), zero = maker.add_vec3({0, 0, 1, 0, 0, 0, 0, 0, 1});
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", long_ones}}}})}});
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", zero}}}})}});
  const Scene scene = maker.load();
  EXPECT_EQ(scene.meshes[0].primitives[0].normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
  // Vertex 1 alone, from its triangle in the plane z = 0; the others as the file has them.
  EXPECT_EQ(scene.meshes[1].primitives[0].normals, (std::vector<Vec3>{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(has_warning(scene, "NORMAL: normals of zero length, NaN or infinity are made from the triangles there"));
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

/// A corner of a cube at (1, 1, 1), one of its three squares cut through the corner: four triangles there, angles 90,
/// 90, 45, 45.
GltfMaker cube_corner(const std::vector<float>& normals) {
  GltfMaker maker;
  const int positions = maker.add_vec3({1, 1, 1, 1, 0, 1, 1, 1, 0, 0, 1, 1, 1, 0, 0});
  maker.add_node(
      {{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", maker.add_vec3(normals)}}},
                                // x = 1 in two, y = 1, z = 1
                                {"indices", maker.add_indices({0, 1, 4, 0, 4, 2, 0, 2, 3, 0, 3, 1})}})}});
  return maker;
}

TEST(GltfLoad, NormalsOfNanAreTheMeanOfTheirTrianglesByAngle) {
  // Weighted by angle, each of the three sides counts 90 degrees: (1, 1, 1) / sqrt 3. Weighted by triangles x would
  // count twice: (2, 1, 1) / sqrt 6.
  std::vector<float> normals{kNan, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 0, 0};
  const float third = 1 / std::sqrt(3.0f);
  for (const float wrong : {kNan, kInfinity, -kInfinity}) {
    normals[0] = wrong;
    const Scene scene = cube_corner(normals).load();
    const std::vector<Vec3>& made = scene.meshes[0].primitives[0].normals;
    ASSERT_EQ(made.size(), 5u);
    EXPECT_NEAR_VEC(made[0], (Vec3{third, third, third}), 1e-6);
    EXPECT_EQ(made[4], (Vec3{1, 0, 0}));
    EXPECT_EQ(scene.warnings.size(), 1u);
  }
  // All wrong: each has its own triangles.
  const Scene scene = cube_corner(std::vector<float>(15, kNan)).load();
  EXPECT_NEAR_VEC(scene.meshes[0].primitives[0].normals[4], (Vec3{1, 0, 0}), 1e-6);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], "are made from the triangles there (5)");
}

TEST(GltfLoad, TriangleBackToBackHasNoNormalToBeMade_FlatShaded) {
  GltfMaker maker;
  const int positions = maker.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0}),
            normals = maker.add_vec3(std::vector<float>(9, kNan));
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                                           {"indices", maker.add_indices({0, 1, 2, 0, 2, 1})}})}});
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.meshes[0].primitives[0].normals.empty());
  EXPECT_TRUE(has_warning(scene, "flat shaded"));
}

TEST(GltfLoad, CoordinatesAndColoursOfNanTakeTheMeanOfTheirNeighbours) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_square()}});
  Json& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = maker.add_accessor(std::vector<float>{0, 0, 1, 0, kNan, 1, 0, 1}, 5126, "VEC2", 2);
  attributes["COLOR_0"] = maker.add_vec3({0, 0, 0, 1, 0, 0, 1, kInfinity, 1, 0, 1, 0});
  const Scene scene = maker.load();
  // Vertex 2 is in triangles 0 1 2 and 0 2 3: its neighbours are 0 twice, 1 and 3.
  EXPECT_EQ(scene.meshes[0].primitives[0].uvs[2].x, 0.25f);
  EXPECT_EQ(scene.meshes[0].primitives[0].uvs[2].y, 0.25f);
  EXPECT_EQ(scene.meshes[0].primitives[0].uvs[1].x, 1.0f);
  EXPECT_EQ(scene.meshes[0].primitives[0].colors[2], (std::array<float, 4>{0.25f, 0.25f, 0, 1}));
  EXPECT_EQ(scene.warnings.size(), 2u);
  EXPECT_TRUE(has_warning(scene, "TEXCOORD_0: texture coordinates with NaN or infinity take the mean"));
  EXPECT_TRUE(has_warning(scene, "COLOR_0: colours with NaN or infinity take the mean"));
}

TEST(GltfLoad, WeightsAndDisplacementsThatAreNoneAreLeftOut) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}, {"skin", 0}});
  maker.add_node(Json::object());
  maker.add_node(Json::object());
  maker.json["skins"] = {{{"joints", {1, 2}}}};
  Json& primitive = maker.json["meshes"][0]["primitives"][0];
  const std::vector<std::uint8_t> joints{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
  primitive["attributes"]["JOINTS_0"] = maker.add_accessor(joints, 5121, "VEC4", 4);
  primitive["attributes"]["WEIGHTS_0"] = maker.add_vec4({0.5f, 0.5f, 0, 0, -1, 0.5f, 0, 0, kNan, 0.5f, 0, 0});
  primitive["targets"] = {{{"POSITION", maker.add_vec3({1, 1, 1, kNan, 1, 1, 2, 2, 2})}}};
  const Scene scene = maker.load();
  const Primitive& read = scene.meshes[0].primitives[0];
  const auto weight = [&](std::size_t vertex, std::size_t i) { return read.influences[vertex * 4 + i].weight; };
  EXPECT_EQ(weight(0, 0), 0.5f);
  EXPECT_EQ(weight(1, 0), 0);
  EXPECT_EQ(weight(1, 1), 1);  // alone, so all
  EXPECT_EQ(weight(2, 0), 1);  // NaN spoils the four of its vertex, which follows its first joint
  EXPECT_EQ(read.targets[0].positions[1], (Vec3{0, 0, 0}));
  EXPECT_EQ(read.targets[0].positions[2], (Vec3{2, 2, 2}));
  EXPECT_TRUE(has_warning(scene, "joint weights below 0, NaN or infinite are left out (2)"));
  EXPECT_TRUE(has_warning(scene, "displacements with NaN or infinity are left out"));
}

TEST(GltfLoad, InstancesThatAreNowhereAreLeftOut) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_square()}});
  Json& attributes = maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = maker.add_vec3({0, 0, 0, kNan, 0, 0, 2, 0, 0, 3, 0, 0});
  attributes["ROTATION"] = maker.add_vec4({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1});
  const Scene scene = maker.load();
  ASSERT_EQ(scene.nodes[0].instances.size(), 2u);
  EXPECT_EQ(scene.nodes[0].instances[1].translation.x, 3);
  EXPECT_TRUE(has_warning(scene, "instances with NaN, infinity or a rotation of zero length are left out (2)"));
}

TEST(LightUnits, LampsOfBlendersDefaultExportAreDoubted) {
  // Blender: W / (4 pi) cd, times 683 by default: 25 W are 1358.8 cd, else 2.
  const auto doubt = [](const char* generator, double intensity, const char* type) {
    GltfMaker maker;
    maker.add_node({{"mesh", maker.add_triangle()}});
    maker.add_light({{"type", type}, {"intensity", intensity}});
    maker.json["asset"]["generator"] = generator;
    return doubt_of_light_units(maker.load());
  };
  const char* const blender = "Khronos glTF Blender I/O v3.4.50";
  EXPECT_CONTAINS(doubt(blender, 1358.8, "point"), "has 1359 cd");
  EXPECT_CONTAINS(doubt(blender, 1358.8, "point"), "--light-units spec (make: LIGHT_UNITS=spec");
  EXPECT_CONTAINS(doubt(blender, 2049, "directional"), "683");
  EXPECT_EQ(doubt(blender, 2, "point"), "");
  EXPECT_EQ(doubt("Khronos glTF Blender I/O v3.4.50, tempolux_export", 1358.8, "point"), "");
  EXPECT_EQ(doubt("obj2gltf", 1358.8, "point"), "");
  EXPECT_EQ(doubt("", 1358.8, "point"), "");
}

TEST(GltfLoad, ABuildingWithNormalsOfNanIsLoaded) {
  const fs::path file = shared_scenes() / "mend/building/subpass_scene_opaque.gltf";
  if (!fs::exists(file)) GTEST_SKIP() << "../shared/scenes/mend is not there";
  const Scene scene = load_gltf(file);  // the vertices with NaN are those of triangles of zero area, which are left out
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives)
      for (const Vec3& normal : primitive.normals) EXPECT_NEAR(length2(normal), 1, 1e-5);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfLoad, AnUnknownInterpolationIsPlayedAsLinear) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.animate(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "WOBBLY");
  for (const char* name : {"", "animation 0"}) {
    const Scene scene = load_gltf(write_file("scene.gltf", maker.text()), {.animation = name});
    ASSERT_EQ(scene.animations.size(), 1u);
    EXPECT_EQ(scene.animations[0].tracks[0].interpolation, AnimationTrack::Interpolation::linear);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_CONTAINS(scene.warnings[0],
                    "channels[0]: channels whose interpolation \"WOBBLY\" glTF does not have are played as LINEAR");
  }
}

TEST(GltfLoad, ABadChannelLeavesTheOthersOfItsAnimationAlone) {
  GltfMaker maker;
  const int moved = maker.add_node({{"mesh", maker.add_triangle()}});
  maker.animate(moved, "translation", {0, 0}, {0, 0, 0, 1, 0, 0});  // a key that repeats its time
  maker.animate(moved, "scale", {0, 2}, {1, 1, 1, 2, 2, 2});
  const Scene scene = maker.load();
  ASSERT_EQ(scene.animations.size(), 1u);
  ASSERT_EQ(scene.animations[0].tracks.size(), 1u);
  EXPECT_EQ(scene.duration_s, 2);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], "channels[0].input: times must increase");
}

TEST(GltfLoad, TrianglesOfZeroAreaAreDroppedAndCounted) {
  GltfMaker maker;
  const int positions = maker.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, 1, 0, 0});
  const int indices = maker.add_indices({0, 1, 2, 0, 0, 1, 0, 1, 3, 1, 4, 2, 0, 3, 2});
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  const Scene scene = maker.load();
  // of five: two corners equal, collinear, two corners at one place
  EXPECT_EQ(scene.meshes[0].primitives[0].triangles.size(), 2u);
  EXPECT_TRUE(has_warning(scene, "triangles of zero area, 3 times"));
}

TEST(GltfLoad, ATinyTriangleIsNoZeroTriangle) {
  GltfMaker maker;
  const float e = std::ldexp(1.0f, -23);
  maker.add_node({{"mesh", maker.add_mesh({{"attributes",
                                            {{"POSITION", maker.add_vec3({1, 1, 0, 1 + e, 1, 0, 1, 1 + e, 0})}}}})}});
  EXPECT_EQ(maker.load().meshes[0].primitives[0].triangles.size(), 1u);
}

TEST(GltfLoad, PrimitivesKeepOnlyTheVerticesTheyUse) {
  GltfMaker maker;
  const int positions = maker.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0});
  const int normals = maker.add_vec3({1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0});
  const Json attributes = {{"POSITION", positions}, {"NORMAL", normals}};
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", attributes}, {"indices", maker.add_indices({5, 3, 4})}})}});
  const Scene scene = maker.load();
  const Primitive& primitive = scene.meshes[0].primitives[0];
  EXPECT_EQ(primitive.positions, (std::vector<Vec3>{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}));
  EXPECT_EQ(primitive.normals[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(primitive.triangles, (std::vector<Triangle>{{2, 0, 1}}));
}

TEST(GltfLoad, MaterialsAreReadWithTheirExtensions) {
  GltfMaker maker;
  maker.add_material(
      {{"name", "M"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 0.125, 1}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"doubleSided", true},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
         {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {1, 2, 3}}}},
         {"KHR_materials_ior", {{"ior", 1.25}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}}}}});
  maker.add_node({{"mesh", maker.add_triangle(0)}});
  maker.add_node({{"mesh", maker.add_triangle()}});
  const Scene scene = maker.load();
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color, (Rgb{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, (Rgb{8, 4, 0}));
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specular_color, (Rgb{1, 2, 3}));
  EXPECT_EQ(m.ior, 1.25f);
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_EQ(scene.meshes[1].primitives[0].material, 1u);  // glTF's default material is the last
  EXPECT_EQ(scene.materials[1], Material{});
}

/// Gives a file a texture of one pixel. Returns the reference to the texture.
Json add_pixel(GltfMaker& maker) {
  const char* pixel =
      "data:image/"
      "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg==";
  maker.json["images"] = {{{"uri", pixel}}};
  maker.json["textures"] = {{{"source", 0}}};
  return {{"index", 0}};
}

TEST(GltfLoad, LayersAreReadWithTheirTextures) {
  GltfMaker maker;
  const Json texture = add_pixel(maker);
  maker.add_material(
      {{"extensions",
        {{"KHR_materials_clearcoat",
          {{"clearcoatFactor", 0.5},
           {"clearcoatRoughnessFactor", 0.25},
           {"clearcoatNormalTexture", {{"index", 0}, {"scale", 0.5}}}}},
         {"KHR_materials_sheen",
          {{"sheenColorFactor", {0.25, 0.5, 1}}, {"sheenRoughnessFactor", 0.75}, {"sheenRoughnessTexture", texture}}},
         {"KHR_materials_specular", {{"specularTexture", texture}, {"specularColorTexture", texture}}},
         {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyRotation", -2}}}}}});
  maker.add_node({{"mesh", maker.add_square(0)}});
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.warnings.empty());
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.clearcoat, 0.5f);
  EXPECT_EQ(m.clearcoat_roughness, 0.25f);
  EXPECT_EQ(m.sheen_color, (Rgb{0.25f, 0.5f, 1}));
  EXPECT_EQ(m.sheen_roughness, 0.75f);
  EXPECT_EQ(m.anisotropy, 0.5f);
  EXPECT_EQ(m.anisotropy_rotation, -2);
  ASSERT_TRUE(m.textures.has_value());
  EXPECT_TRUE(m.textures->clearcoat_normal && m.textures->sheen_roughness && m.textures->specular &&
              m.textures->specular_color && m.textures->grain);
  EXPECT_FALSE(m.textures->clearcoat || m.textures->sheen_color || m.textures->anisotropy);
  EXPECT_EQ(m.textures->clearcoat_normal_scale, 0.5f);
}

TEST(GltfLoad, FilmsAndDispersionAreRead) {
  GltfMaker maker;
  const Json texture = add_pixel(maker);
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {
      "KHR_materials_iridescence", "KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_dispersion"};
  maker.add_material({{"extensions",
                       {{"KHR_materials_iridescence",
                         {{"iridescenceFactor", 0.5},
                          {"iridescenceIor", 1.75},
                          {"iridescenceThicknessMinimum", 200},
                          {"iridescenceThicknessMaximum", 600},
                          {"iridescenceTexture", texture},
                          {"iridescenceThicknessTexture", texture}}},
                        {"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                        {"KHR_materials_volume", {{"thicknessFactor", 1}}},
                        {"KHR_materials_dispersion", {{"dispersion", 0.25}}}}}});
  maker.add_node({{"mesh", maker.add_square(0)}});
  const Scene scene = maker.load();
  EXPECT_TRUE(scene.warnings.empty());
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.iridescence, 0.5f);
  EXPECT_EQ(m.iridescence_ior, 1.75f);
  EXPECT_EQ(m.iridescence_thickness_minimum, 200);
  EXPECT_EQ(m.iridescence_thickness_maximum, 600);
  EXPECT_EQ(m.dispersion, 0.25f);
  ASSERT_TRUE(m.textures.has_value());
  EXPECT_TRUE(m.textures->iridescence && m.textures->iridescence_thickness);
}

TEST(GltfLoad, ReflectanceOutsideZeroToOneIsClampedWithAWarning) {
  GltfMaker maker;
  maker.add_material({{"name", "Bright"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1.5, -1, 0.5, 1}}}}});
  maker.add_node({{"mesh", maker.add_triangle(0)}});
  const Scene scene = maker.load();
  EXPECT_EQ(scene.materials[0].base_color, (Rgb{1, 0, 0.5f}));
  EXPECT_TRUE(has_warning(scene, "materials[0] \"Bright\".baseColorFactor: 1.5"));
  EXPECT_EQ(scene.warnings.size(), 2u);
}

TEST(GltfLoad, WhatIsNotRenderedYetIsNamed) {
  GltfMaker maker;
  maker.add_material({{"occlusionTexture", {{"index", 0}}}});
  maker.add_node({{"mesh", maker.add_triangle(0)}});
  Json& primitive = maker.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["COLOR_1"] = 0;
  maker.json["skins"] = {{{"joints", {0}}}};
  maker.json["nodes"][0]["skin"] = 0;  // but its mesh has no JOINTS_0
  maker.add_light({{"type", "point"}, {"range", 10}});
  maker.animate(0, "translation", {0}, {0, 0, 0});
  Json pointer = maker.json["animations"][0]["channels"][0];
  pointer["target"] = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/materials/0"}}}}}};
  maker.json["animations"][0]["channels"].push_back(pointer);
  const Scene scene = maker.load();
  for (const char* part : {"occlusion textures", "second and further vertex colours",
                           "skins of meshes without JOINTS_0", "range of lights", "animation of /materials/0"})
    EXPECT_TRUE(has_warning(scene, part)) << part;
}

/// Bytes count 255ths, float colours keep their values, and RGB has alpha 1. Only the material of these vertices is
/// marked as varying.
TEST(GltfLoad, ColoursOfVertices) {
  GltfMaker maker;
  for (int i = 0; i < 4; ++i) maker.add_material(Json::object());
  const int bytes = maker.add_accessor<std::uint8_t>({255, 0, 51, 102, 0, 255, 0, 255, 0, 0, 255, 0}, 5121, "VEC4", 4);
  maker.json["accessors"][std::size_t(bytes)]["normalized"] = true;
  const std::vector<int> accessors{bytes, maker.add_vec3({0.5f, 0, 0, 0, 0.25f, 0, 0, 2, 1}),
                                   maker.add_vec3(std::vector<float>(9, 1))};
  for (int m = 0; m < 3; ++m) {
    maker.add_node({{"mesh", maker.add_triangle(m)}});
    maker.json["meshes"][std::size_t(m)]["primitives"][0]["attributes"]["COLOR_0"] = accessors[std::size_t(m)];
  }
  const Scene scene = maker.load();
  const auto colors = [&](std::size_t m) { return scene.meshes[m].primitives[0].colors; };
  ASSERT_EQ(colors(0).size(), 3u);
  EXPECT_EQ(colors(0)[0], (std::array<float, 4>{1, 0, 0.2f, 0.4f}));
  EXPECT_EQ(colors(0)[2], (std::array<float, 4>{0, 0, 1, 0}));
  ASSERT_EQ(colors(1).size(), 3u);
  EXPECT_EQ(colors(1)[0], (std::array<float, 4>{0.5f, 0, 0, 1}));
  EXPECT_EQ(colors(1)[2], (std::array<float, 4>{0, 1, 1, 1})) << "more than all is not reflected";
  EXPECT_TRUE(has_warning(scene, "vertex colours"));
  EXPECT_TRUE(colors(2).empty()) << "white says nothing";
  EXPECT_TRUE(scene.materials[0].textures && scene.materials[0].textures->vertex_colors);
  EXPECT_TRUE(scene.materials[1].textures);
  EXPECT_FALSE(scene.materials[2].textures);
  EXPECT_FALSE(scene.materials[3].textures);
  maker.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = maker.add_vec3({1, 1, 1});
  const Scene few = maker.load();
  EXPECT_TRUE(has_warning(few, "meshes[0].primitives[0].COLOR_0: 1 colours for 3 positions are left out"));
  EXPECT_TRUE(few.meshes[0].primitives[0].colors.empty());
}

TEST(GltfLoad, NodesComeParentsFirstAndOnlyFromTheDefaultScene) {
  GltfMaker maker;
  const int leaf = maker.add_node({{"name", "leaf"}, {"mesh", maker.add_triangle()}}, false);
  maker.add_node({{"name", "elsewhere"}, {"mesh", 0}}, false);
  maker.add_node({{"name", "root"}, {"children", {leaf}}});
  const Scene scene = maker.load();
  ASSERT_EQ(scene.nodes.size(), 2u);
  EXPECT_EQ(scene.nodes[0].name, "root");
  EXPECT_EQ(scene.nodes[1].parent, 0);
  EXPECT_EQ(scene.nodes[1].source_index, 0u);
  EXPECT_EQ(scene.object_names, std::vector<std::string>{"leaf"});
}

TEST(GltfLoad, AVeryDeepHierarchyIsNoRecursion) {
  GltfMaker maker;
  const int mesh = maker.add_triangle();
  constexpr int kDepth = 100'000;
  for (int i = 0; i < kDepth; ++i) maker.json["nodes"].push_back({{"children", {i + 1}}});
  maker.json["nodes"].push_back({{"mesh", mesh}});
  maker.json["scenes"][0]["nodes"] = {0};
  EXPECT_EQ(maker.load().nodes.size(), std::size_t(kDepth + 1));
}

TEST(GltfLoad, NodesWithTwoParentsOrInALoopAreRefused) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}, {"children", {1}}});
  maker.add_node({{"children", Json::array()}});
  EXPECT_CONTAINS(error_of(maker), "is reached twice");
  maker.json["scenes"][0]["nodes"] = {0};
  EXPECT_EQ(maker.load().nodes.size(), 2u);
  maker.json["nodes"][1]["children"] = {0};
  EXPECT_CONTAINS(error_of(maker), "is reached twice");
}

TEST(GltfLoad, NumbersThatAreNotFiniteAreRefusedWithMeshAndAccessor) {
  GltfMaker maker;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  maker.add_node(
      {{"mesh", maker.add_mesh({{"attributes", {{"POSITION", maker.add_vec3({0, 0, 0, 1, 0, nan, 0, 1, 0})}}}})}});
  EXPECT_CONTAINS(error_of(maker), "meshes[0].primitives[0].POSITION: accessor 0 holds NaN");
}

TEST(GltfLoad, IndicesBeyondTheVerticesAreRefused) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", maker.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
                                           {"indices", maker.add_indices({0, 1, 3})}})}});
  EXPECT_CONTAINS(error_of(maker), "index 3 is beyond the 3 vertices");
}

TEST(GltfLoad, ABadChannelIsNotPlayedWithAWarning_AskedForByNameItIsRefused) {
  const auto animated = [](const char* path, std::vector<float> times, std::vector<float> values, const char* how) {
    GltfMaker maker;
    maker.add_node({{"mesh", maker.add_triangle()}});
    maker.animate(0, path, times, values, how);
    return maker;
  };
  // The scene is static, and one warning gives the reason. If the animation is requested by name, it is refused with
  // the same words.
  const auto trouble_of = [](const GltfMaker& maker) {
    const Scene scene = maker.load();
    EXPECT_TRUE(scene.animations.empty());
    EXPECT_EQ(scene.duration_s, 0);
    if (scene.warnings.size() != 1) return std::string("not one warning");
    const std::string refused = load_error(write_file("scene.gltf", maker.text()), {.animation = "animation 0"});
    EXPECT_EQ(scene.warnings[0], refused + "; this channel is not played");
    return refused;
  };
  EXPECT_CONTAINS(trouble_of(animated("translation", {0, 0}, {0, 0, 0, 1, 0, 0}, "LINEAR")), "times must increase");
  EXPECT_CONTAINS(trouble_of(animated("translation", {0, 1}, {0, 0, 0}, "LINEAR")), "1 values for 2 keys");
  EXPECT_CONTAINS(trouble_of(animated("translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "CUBICSPLINE")), "three each");
  EXPECT_CONTAINS(trouble_of(animated("rotation", {0}, {0, 0, 0, 0}, "LINEAR")), "quaternion of zero length");
  GltfMaker maker = animated("translation", {0}, {0, 0, 0}, "LINEAR");
  maker.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  EXPECT_CONTAINS(trouble_of(maker), "given by a matrix");
}

TEST(GltfLoad, ABadAnimationLeavesTheOthersAlone) {
  GltfMaker maker;
  const int moved = maker.add_node({{"mesh", maker.add_triangle()}});
  maker.animate(moved, "translation", {0, 0}, {0, 0, 0, 1, 0, 0});  // a key that repeats its time
  maker.json["animations"].push_back({{"name", "Turn"}, {"channels", Json::array()}, {"samplers", Json::array()}});
  std::swap(maker.json["animations"][0], maker.json["animations"][1]);
  maker.animate(moved, "scale", {0, 2}, {1, 1, 1, 2, 2, 2});
  const Scene scene = maker.load();
  ASSERT_EQ(scene.animations.size(), 1u);
  EXPECT_EQ(scene.animations[0].name, "Turn");
  EXPECT_EQ(scene.duration_s, 2);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings[0], "key 1 does not; this channel is not played");
}

// Other readers take such cones as they are. They must not cost the rest of the scene: angles are brought into their
// range, and each warning names its light.
TEST(GltfLoad, BadConesOfSpotsAreMended) {
  const auto spot = [](double inner, double outer) {
    GltfMaker maker;
    maker.add_node({{"mesh", maker.add_triangle()}});
    maker.add_light({{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}});
    Scene scene = maker.load();
    EXPECT_EQ(scene.lights.size(), 1u);
    return scene;
  };
  const Scene wide = spot(0.5, 0.4), negative = spot(-1, 0.4), narrow = spot(0, -2), open = spot(0.3, 3),
              equal = spot(0.4, 0.4);
  EXPECT_FLOAT_EQ(wide.lights[0].outer_cone_rad, 0.4f);
  EXPECT_LT(wide.lights[0].inner_cone_rad, 0.4f);
  EXPECT_NEAR(wide.lights[0].inner_cone_rad, 0.4f, 1e-3f);
  ASSERT_EQ(wide.warnings.size(), 1u);
  EXPECT_CONTAINS(wide.warnings[0], "lights[0].spot.innerConeAngle");
  EXPECT_EQ(negative.lights[0].inner_cone_rad, 0);
  EXPECT_GT(narrow.lights[0].outer_cone_rad, 0);
  ASSERT_EQ(narrow.warnings.size(), 1u);
  EXPECT_CONTAINS(narrow.warnings[0], "lights[0].spot.outerConeAngle");
  EXPECT_NEAR(open.lights[0].outer_cone_rad, M_PI / 2, 1e-5);
  EXPECT_EQ(equal.lights[0].inner_cone_rad, wide.lights[0].inner_cone_rad);
  EXPECT_TRUE(equal.warnings.empty());  // Blender writes equal angles
}

TEST(GltfLoad, BadNodesAndLightsAreLeftOut) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}, {"rotation", {0, 0, 0, 0}}});
  EXPECT_TRUE(has_warning(maker.load(), "nodes[0].rotation: what is not a quaternion is left out"));
  maker.add_node({{"mesh", 7}});
  const Scene scene = maker.load();
  EXPECT_TRUE(has_warning(scene, "nodes[1].mesh: index 7 does not exist"));
  EXPECT_EQ(scene.nodes[1].mesh, -1);
  maker.add_light({{"type", "area"}, {"intensity", 5}});
  const Scene lamp = maker.load();
  EXPECT_TRUE(has_warning(lamp, "type must be point, spot or directional"));
  EXPECT_EQ(lamp.lights[0].intensity, Rgb(0.0f));
}

TEST(GltfLoad, CamerasAreFoundByNameAndTheirAbsenceSaysWhatToTick) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  try {
    maker.load().camera_node("auto");
    ADD_FAILURE();
  } catch (const InputError& error) { EXPECT_CONTAINS(error.what(), "Include > Cameras"); }
  maker.add_camera({{"name", "First"}});
  maker.add_camera({{"name", "Second"}});
  const Scene scene = maker.load();
  EXPECT_EQ(scene.nodes[std::size_t(scene.camera_node("auto"))].name, "First");
  EXPECT_EQ(scene.nodes[std::size_t(scene.camera_node("Second"))].name, "Second");
  try {
    scene.camera_node("Third");
    ADD_FAILURE();
  } catch (const InputError& error) { EXPECT_CONTAINS(error.what(), "First, Second"); }
  maker.add_camera(Json::object());
  const Scene with_unnamed = maker.load();
  EXPECT_EQ(with_unnamed.camera_node("camera 2"), 3);
}

TEST(GltfLoad, ASceneWithoutLightSaysWhatToTick) {
  GltfMaker maker;
  maker.add_material({{"emissiveFactor", {0, 0, 0.5}}});
  maker.add_node({{"mesh", maker.add_triangle()}});
  try {
    require_lights(maker.load());
    ADD_FAILURE();
  } catch (const InputError& error) { EXPECT_CONTAINS(error.what(), "Punctual Lights"); }
  GltfMaker lamp = maker, emitter = maker;
  lamp.add_light({{"type", "point"}});
  EXPECT_NO_THROW(require_lights(lamp.load()));
  emitter.add_node({{"mesh", emitter.add_triangle(0)}});
  EXPECT_NO_THROW(require_lights(emitter.load()));
}

}  // namespace
}  // namespace tempolux
