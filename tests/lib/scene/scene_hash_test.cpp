// tests/lib/scene/scene_hash_test.cpp -- each edit changes the hashes of its own concern and no other.
#include <cmath>
#include <functional>
#include <set>

#include "formats/error.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// A scene with a floor, an emissive square, a moving square, a lamp, two used materials and a camera.
GltfMaker room() {
  GltfMaker maker;
  maker.add_material({{"name", "Grey"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}});
  maker.add_material({{"name", "Lamp"}, {"emissiveFactor", {1, 1, 1}}});
  const int grey = maker.add_square(0), bright = maker.add_square(1);
  maker.add_node({{"name", "Floor"}, {"mesh", grey}});
  maker.add_node({{"name", "Panel"}, {"mesh", bright}, {"translation", {0, 2, 0}}});
  const int mover = maker.add_node({{"name", "Mover"}, {"mesh", grey}});
  maker.animate(mover, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  maker.add_light({{"type", "point"}, {"intensity", 3}}, {{"name", "Bulb"}, {"translation", {0, 1, 0}}});
  maker.add_camera({{"name", "Camera"}, {"translation", {0, 0, 5}}});
  return maker;
}

constexpr int kFloor = 0, kPanel = 1, kBulb = 3, kCamera = 4;

SceneHashes hashes(const GltfMaker& maker, int frame = 5) {
  const Scene scene = maker.load();
  return scene_at_frame(scene, segment_of(scene, frame, {}), frame, {}).hashes;
}

/// The names of the hashes that differ.
std::set<std::string> changed(const SceneHashes& a, const SceneHashes& b) {
  std::set<std::string> names;
  if (a.camera != b.camera) names.insert("camera");
  if (a.static_geometry != b.static_geometry) names.insert("static");
  if (a.moving_geometry != b.moving_geometry) names.insert("moving");
  if (a.lights != b.lights) names.insert("lights");
  if (a.materials != b.materials) names.insert("materials");
  if (a.media != b.media) names.insert("media");
  return names;
}

std::set<std::string> changed_by(const std::function<void(Json&)>& edit) {
  GltfMaker edited = room();
  edit(edited.json);
  return changed(hashes(room()), hashes(edited));
}

using Names = std::set<std::string>;

TEST(SceneHash, HasThirtyTwoDigitsEach) {
  const SceneHashes h = hashes(room());
  for (const std::string& hash : {h.camera, h.static_geometry, h.moving_geometry, h.lights, h.materials, h.media}) {
    EXPECT_EQ(hash.size(), 32u);
    EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

TEST(SceneHash, NamesAndOrderAndFileDoNotCount) {
  EXPECT_EQ(changed_by([](Json& json) { json["nodes"][kFloor]["name"] = "Ground"; }), Names{});
  EXPECT_EQ(changed_by([](Json& json) { json["materials"][0]["name"] = "Gray"; }), Names{});
  EXPECT_EQ(changed_by([](Json& json) {
              json["asset"]["generator"] = "another";
              json["extras"] = {1, 2};
            }),
            Names{});
  const GltfMaker maker = room();
  const Scene a = load_gltf(write_file("one.gltf", maker.text())), b = load_gltf(write_file("two.glb", maker.glb()));
  EXPECT_EQ(changed(scene_at_frame(a, segment_of(a, 5, {}), 5, {}).hashes,
                    scene_at_frame(b, segment_of(b, 5, {}), 5, {}).hashes),
            Names{});
}

TEST(SceneHash, TheOrderOfAFilesListsDoesNotCount) {
  EXPECT_EQ(changed_by([](Json& json) {
              std::swap(json["materials"][0], json["materials"][1]);
              for (Json& mesh : json["meshes"])
                mesh["primitives"][0]["material"] = 1 - mesh["primitives"][0]["material"].get<int>();
            }),
            Names{});
  EXPECT_EQ(changed_by([](Json& json) {
              std::swap(json["meshes"][0], json["meshes"][1]);
              for (Json& node : json["nodes"])
                if (node.contains("mesh")) node["mesh"] = 1 - node["mesh"].get<int>();
            }),
            Names{});
  EXPECT_EQ(changed_by([](Json& json) {  // nodes elsewhere in the list, in the same order in the scene
              std::swap(json["nodes"][kFloor], json["nodes"][kCamera]);
              json["scenes"][0]["nodes"] = {4, 1, 2, 3, 0};
            }),
            Names{});
}

TEST(SceneHash, UnusedPartsDoNotCount) {
  EXPECT_EQ(changed_by([](Json& json) {
              json["materials"].insert(json["materials"].begin(), Json::object({{"name", "Unused"}}));
              for (Json& mesh : json["meshes"])
                mesh["primitives"][0]["material"] = 1 + mesh["primitives"][0]["material"].get<int>();
            }),
            Names{});
}

TEST(SceneHash, TheCameraChangesOnlyItsOwn) {
  EXPECT_EQ(changed_by([](Json& json) { json["nodes"][kCamera]["translation"] = {0, 0, 6}; }), Names{"camera"});
  EXPECT_EQ(changed_by([](Json& json) { json["cameras"][0]["perspective"]["yfov"] = 0.9; }), Names{"camera"});
  EXPECT_EQ(changed_by([](Json& json) { json["cameras"][0]["perspective"]["znear"] = 0.2; }), Names{});
  EXPECT_EQ(changed_by([](Json& json) { json["cameras"][0]["extras"]["lens_shift"] = {0.1, 0}; }), Names{"camera"});
  EXPECT_EQ(changed_by([](Json& json) { json["cameras"][0]["extras"]["lens_shift"] = {0, 0.1}; }), Names{"camera"});
  EXPECT_EQ(changed_by([](Json& json) { json["cameras"][0]["extras"]["lens_shift"] = {0, 0}; }), Names{});
  GltfMaker walking = room();
  walking.animate(kCamera, "translation", {0, 1}, {0, 0, 5, 0, 0, 9});
  EXPECT_EQ(changed(hashes(room()), hashes(walking)), Names{"camera"});
}

TEST(SceneHash, ALampChangesOnlyLights) {
  EXPECT_EQ(changed_by([](Json& json) { json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = 4; }),
            Names{"lights"});
  EXPECT_EQ(changed_by([](Json& json) { json["extensions"]["KHR_lights_punctual"]["lights"][0]["name"] = "x"; }),
            Names{});
  EXPECT_EQ(changed_by([](Json& json) { json["nodes"][kBulb]["translation"] = {0, 1.5, 0}; }), Names{"lights"});
  EXPECT_EQ(changed_by([](Json& json) {
              json["nodes"][kBulb]["rotation"] = {1, 0, 0, 0};
            }),
            Names{});  // a point light has no direction
  EXPECT_EQ(changed_by([](Json& json) { json["materials"][1]["emissiveFactor"] = {1, 0.5, 1}; }), Names{"lights"});
}

TEST(SceneHash, AMaterialChangesOnlyMaterials) {
  EXPECT_EQ(changed_by([](Json& json) { json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 0.5; }),
            Names{"materials"});
  EXPECT_EQ(changed_by([](Json& json) {
              json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
            }),
            Names{"materials"});
}

TEST(SceneHash, GeometryChangesItsOwnPart) {
  EXPECT_EQ(changed_by([](Json& json) { json["nodes"][kFloor]["translation"] = {0, -1, 0}; }), Names{"static"});
  EXPECT_EQ(changed_by([](Json& json) {
              json["nodes"][kPanel]["translation"] = {0, 3, 0};
            }),
            (Names{"static", "lights"}));
  GltfMaker other = room();
  other.json["animations"] = Json();
  other.json.erase("animations");
  other.animate(2, "translation", {0, 1}, {0, 0, 0, 2, 0, 0});
  EXPECT_EQ(changed(hashes(room()), hashes(other)), Names{"moving"});
  GltfMaker coloured = room();  // the square that stands is the one that moves
  coloured.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      coloured.add_vec3({1, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1});
  EXPECT_EQ(changed(hashes(room()), hashes(coloured)), (Names{"static", "moving"}));
}

TEST(SceneHash, FramesDifferInWhatMovesOnly) {
  EXPECT_EQ(changed(hashes(room(), 5), hashes(room(), 6)), Names{"moving"});
}

TEST(SceneHash, AnEditInOneSegmentLeavesTheOthersEqual) {
  GltfMaker before = room(), after = room();
  for (GltfMaker* maker : {&before, &after}) {
    maker->json.erase("animations");
    const float end = maker == &after ? 5.0f : 2.0f;
    maker->animate(2, "translation", {0, 1, 2, 3}, {0, 0, 0, 1, 0, 0, 1, 0, 0, end, 0, 0});
  }
  EXPECT_EQ(changed(hashes(before, 10), hashes(after, 10)), Names{});
  EXPECT_EQ(changed(hashes(before, 30), hashes(after, 30)), Names{});  // stands still between 1 s and 2 s
  EXPECT_EQ(changed(hashes(before, 60), hashes(after, 60)), Names{"moving"});
}

TEST(SceneHash, OneCameraHasAHashOfItsOwn) {
  GltfMaker maker = room();
  maker.add_camera({{"name", "Second"}});
  const Scene scene = maker.load();
  const SceneFrame at = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
  EXPECT_NE(camera_hash(at.camera(scene.camera_node("Camera"))), camera_hash(at.camera(scene.camera_node("Second"))));
}

TEST(SceneHash, ReexportedEqualDependsOnNoMemoryOrTime) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const std::string path = (shared_scenes() / "made/S4_atrium.glb").string();
  const Scene a = load_gltf(path), b = load_gltf(path);
  EXPECT_EQ(changed(scene_at_frame(a, segment_of(a, 30, {}), 30, {}).hashes,
                    scene_at_frame(b, segment_of(b, 30, {}), 30, {}).hashes),
            Names{});
  const SceneHashes first = scene_at_frame(a, segment_of(a, 0, {}), 0, {}).hashes,
                    later = scene_at_frame(a, segment_of(a, 40, {}), 40, {}).hashes;
  EXPECT_EQ(changed(first, later), Names{"camera"});  // only the camera walks, in both segments
}

TEST(SceneHash, EnvironmentIsALight) {
  const auto under = [](float radiance) {
    Scene scene = room().load();
    scene.environment = std::make_shared<const Environment>(uniform_environment(Rgb(radiance), {}));
    return scene_at_frame(scene, segment_of(scene, 5, {}), 5, {}).hashes;
  };
  EXPECT_EQ(changed(hashes(room()), under(1)), Names{"lights"});
  EXPECT_EQ(changed(under(1), under(2)), Names{"lights"});
}

TEST(SceneHash, EnvironmentIsLightEnough) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  Scene scene = maker.load();
  EXPECT_THROW(require_lights(scene), InputError);
  scene.environment = std::make_shared<const Environment>(uniform_environment(Rgb(1.0f), {}));
  EXPECT_NO_THROW(require_lights(scene));
  scene.environment = std::make_shared<const Environment>(uniform_environment(Rgb(0.0f), {}));
  EXPECT_THROW(require_lights(scene), InputError);
}

}  // namespace
}  // namespace tempolux
