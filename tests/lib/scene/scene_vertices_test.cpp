// tests/lib/scene/scene_vertices_test.cpp -- animated vertices of whole files against a second reader in Python.
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <sstream>

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// One line of vertices.py.
struct Expected {
  std::uint32_t node = 0, primitive = 0, triangle = 0, corner = 0;
  double time_s = 0;
  Vec3d position{};
};

std::vector<Expected> second_reader(const std::string& file, int animation) {
  const std::string command = "python3 lib/scene/vertices.py '" + file + "' " + std::to_string(animation);
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  std::vector<Expected> lines;
  std::array<char, 512> line{};
  while (pipe && std::fgets(line.data(), int(line.size()), pipe.get())) {
    Expected e;
    std::istringstream(line.data()) >> e.node >> e.primitive >> e.triangle >> e.corner >> e.time_s >> e.position.x >>
        e.position.y >> e.position.z;
    lines.push_back(e);
  }
  return lines;
}

/// Ten vertices of every primitive at ten times agree to 1e-6 of the scene's size. One rounding of coordinates to
/// float32 is 6e-8 of it; the rest is the rounding of the frame's time against the file's keys.
void expect_same_vertices(const std::string& file, int animation) {
  const std::vector<Expected> expected = second_reader(file, animation);
  ASSERT_GE(expected.size(), 100u) << file << ": the second reader failed";
  GltfOptions options;
  {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    const std::size_t begin = bytes.starts_with("glTF") ? 20 : 0;
    std::uint32_t length = std::uint32_t(bytes.size());
    if (begin) std::memcpy(&length, bytes.data() + 12, 4);
    const Json document = Json::parse(bytes.substr(begin, length));
    options.animation =
        document["animations"][std::size_t(animation)].value("name", "animation " + std::to_string(animation));
  }
  const Scene scene = load_gltf(file, options);
  std::map<int, SceneFrame> frames;
  double largest_error = 0;
  for (const Expected& e : expected) {
    const int frame = int(std::lround(e.time_s * 24));
    if (!frames.contains(frame)) frames.emplace(frame, scene_at_frame(scene, segment_of(scene, frame, {}), frame, {}));
    const SceneFrame& at = frames.at(frame);
    std::uint32_t rank = e.primitive;
    const Surface* surface = nullptr;
    for (const Surface& s : at.surfaces)
      if (scene.nodes[s.node].source_index == e.node && rank-- == 0) surface = &s;
    ASSERT_TRUE(surface);
    const Vec3d position = Vec3d(surface->position(surface->primitive->triangles[e.triangle][e.corner])) + at.origin;
    const double size = double(length(at.bounds.upper - at.bounds.lower));
    largest_error = std::max(largest_error, length(position - e.position) / size);
    const Box3d& bounds = at.segment.world_bounds;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(e.position[axis], bounds.lower[axis] - 1e-6 * size);
      EXPECT_LE(e.position[axis], bounds.upper[axis] + 1e-6 * size);
    }
  }
  EXPECT_LT(largest_error, 1e-6) << file << " animation " << animation;
}

TEST(Vertices, OfFoundScenesAgreeWithASecondReader) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const std::map<std::string, int> files{{"assimp/simple_skin.gltf", 0},
                                         {"assimp/AnimatedMorphCube/AnimatedMorphCube.gltf", 0},
                                         {"bevy/Fox.glb", 0},
                                         {"bevy/MorphStressTest.gltf", 2},
                                         {"wicked/CesiumMan.glb", 0},
                                         {"renderling/box_animated.glb", 0},
                                         {"trimesh/CesiumMilkTruck.glb", 0},
                                         {"blender-io/03_all_animations/03_all_animations.gltf", 0},
                                         {"blender-io/06_parent-inverse-anim/06_parent-inverse-anim.gltf", 1},
                                         {"blender-io/07_nla-anim/07_nla-anim.gltf", 0}};
  for (const auto& [name, animation] : files)
    expect_same_vertices((shared_scenes() / "found/gltf" / name).string(), animation);
}

/// A strip of ten squares that bends, with two sets of joints, quantised positions, a sparse morph target, every
/// interpolation: what the found files do not have together.
TEST(Vertices, OfAStripWithEverythingAgreeWithASecondReader) {
  GltfMaker maker;
  std::vector<std::int16_t> positions;
  std::vector<std::uint8_t> joints0, joints1, weights0, weights1;
  std::vector<std::uint16_t> indices;
  for (int i = 0; i <= 10; ++i)
    for (int side = 0; side < 2; ++side) {
      positions.insert(positions.end(),
                       {std::int16_t(3000 * i), std::int16_t(side * 9000), std::int16_t(i * i * 100), 0});
      const auto far = std::uint8_t(255 * i / 10);
      joints0.insert(joints0.end(), {0, 0, 0, 0});
      weights0.insert(weights0.end(), {std::uint8_t(255 - far), 0, 0, 0});
      joints1.insert(joints1.end(), {0, 1, 0, 0});
      weights1.insert(weights1.end(), {0, far, 0, 0});
    }
  for (std::uint16_t i = 0; i < 20; i = std::uint16_t(i + 2))
    for (const int k : {0, 2, 1, 1, 2, 3}) indices.push_back(std::uint16_t(i + k));
  Json attributes;
  attributes["POSITION"] = maker.add_accessor(positions, 5122, "VEC3", 4);
  maker.json["bufferViews"].back()["byteStride"] = 8;
  maker.json["accessors"].back()["normalized"] = true;
  attributes["JOINTS_0"] = maker.add_accessor(joints0, 5121, "VEC4", 4);
  attributes["JOINTS_1"] = maker.add_accessor(joints1, 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] = maker.add_accessor(weights0, 5121, "VEC4", 4);
  maker.json["accessors"].back()["normalized"] = true;
  attributes["WEIGHTS_1"] = maker.add_accessor(weights1, 5121, "VEC4", 4);
  maker.json["accessors"].back()["normalized"] = true;
  // a target without bufferView: zero but for three sparse vertices
  const int values = maker.add_vec3({0, 0, 0.5f, 0, 0.25f, 0, 0.125f, 0, 0});
  const int at = maker.add_accessor(std::vector<std::uint8_t>{1, 7, 20}, 5121, "SCALAR", 1);
  maker.json["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 22},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 3},
         {"indices", {{"bufferView", maker.json["accessors"][std::size_t(at)]["bufferView"]}, {"componentType", 5121}}},
         {"values", {{"bufferView", maker.json["accessors"][std::size_t(values)]["bufferView"]}}}}}});
  const int target = int(maker.json["accessors"].size()) - 1;
  const int mesh = maker.add_mesh(
      {{"attributes", attributes}, {"indices", maker.add_indices(indices)}, {"targets", {{{"POSITION", target}}}}});
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  maker.add_node({{"mesh", mesh}, {"skin", 0}});
  const int tip = maker.add_node({{"translation", {0.5, 0, 0}}}, false);
  const int root = maker.add_node({{"children", {tip}}, {"scale", {1, 2, -1.5}}});
  const int bind = maker.add_accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,     0, 0, 1,
                                                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5f, 0, 0, 1},
                                      5126, "MAT4", 16);
  maker.json["skins"] = {{{"joints", {root, tip}}, {"inverseBindMatrices", bind}}};
  const float h = std::sqrt(0.5f);
  maker.animate(tip, "rotation", {0, 1.5f, 3}, {0, 0, 0, 1, 0, 0, h, h, 0, h, 0, -h});
  maker.animate(tip, "scale", {0, 2}, {1, 1, 1, 1, 0.5f, 2}, "STEP");
  maker.animate(root, "rotation", {0, 3},
                {0, 0, 0, 0, 0, 0, 0, 1, 0.3f, -0.2f, 0.1f, 0, 0.5f, 0, 0, 0, h, 0, 0, h, 0, 0, 0, 0}, "CUBICSPLINE");
  maker.animate(root, "translation", {0, 3}, {0, 0, 0, 0, 0, 0, 1, 2, 3, -4, 5, 6, 1, 1, 1, 0, 0, 0}, "CUBICSPLINE");
  maker.animate(0, "translation", {0, 1, 3}, std::vector<float>(9, 0));
  Json& animation = maker.json["animations"][0];
  animation["samplers"].back()["output"] = maker.add_scalars({0, 2, -1});
  animation["channels"].back()["target"]["path"] = "weights";
  expect_same_vertices(write_file("strip.gltf", maker.text()), 0);
}

}  // namespace
}  // namespace tempolux
