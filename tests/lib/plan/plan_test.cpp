// Plans of a small room with a box that moves, made by hand; what is equal is known from how it was made.
#include "lib/plan/plan.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "lib/plan/plan_files.h"

namespace tempolux {
namespace {

constexpr int kCamera = 0, kLamp = 1, kBox = 3;

Primitive triangle(std::uint32_t material) {
  Primitive primitive;
  primitive.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  primitive.triangles = {{0, 1, 2}};
  primitive.material = material;
  return primitive;
}

Material matte(const char* name, float albedo) {
  Material material;
  material.name = name;
  material.base_color = Rgb(albedo);
  material.metallic = material.specular = 0;
  return material;
}

/// Camera, point lamp, floor, box; nothing moves.
Scene still_room() {
  Scene scene;
  scene.path = "room.glb";
  scene.files = {"room.glb", "data folder/room.bin"};
  scene.cameras = {Camera{}};
  scene.lights = {PunctualLight{}};
  scene.materials = {matte("grey", 0.5f)};
  scene.meshes = {Mesh{"floor", {triangle(0)}}, Mesh{"box", {triangle(0)}}};
  scene.nodes.resize(4);
  scene.nodes[kCamera].name = "Camera";
  scene.nodes[kCamera].camera = 0;
  scene.nodes[kCamera].translation = {0, 0, 5};
  scene.nodes[kLamp].name = "Lamp";
  scene.nodes[kLamp].light = 0;
  scene.nodes[kLamp].translation = {0, 3, 0};
  scene.nodes[2].name = "Floor";
  scene.nodes[2].mesh = 0;
  scene.nodes[2].object = 0;
  scene.nodes[kBox].name = "Box";
  scene.nodes[kBox].mesh = 1;
  scene.nodes[kBox].object = 1;
  scene.object_names = {"Floor", "Box"};
  return scene;
}

/// Puts `node` at x = places[f] at frame f, 24 frames per second.
void slide(Scene& scene, int node, const std::vector<double>& places) {
  AnimationTrack track;
  track.target = node;
  const Vec3d rest = scene.nodes[std::size_t(node)].translation;
  for (std::size_t f = 0; f < places.size(); ++f) {
    track.times_s.push_back(double(f) / 24);
    track.values.insert(track.values.end(), {places[f], rest.y, rest.z});
  }
  scene.animations.push_back({"slide", {track}});
  scene.duration_s = std::max(scene.duration_s, track.times_s.back());
}

Plan plan_of(const Scene& scene, const std::vector<int>& frames, int segment_length = 24) {
  TimeOptions time;
  time.segment_length = segment_length;
  return make_plan(scene, frames, kCamera, time);
}

/// Frame asked for -> frame whose photons it uses.
std::map<int, int> lit_frames(const Plan& plan) {
  std::map<int, int> lit;
  for (const PlannedSegment& segment : plan.segments)
    for (const PlannedFrame& frame : segment.frames)
      if (frame.asked) lit[frame.frame] = frame.lit_frame;
  return lit;
}

/// Frame asked for -> frame that shows the same.
std::map<int, int> pictures(const Plan& plan) {
  std::map<int, int> same;
  for (const PlannedSegment& segment : plan.segments)
    for (const PlannedFrame& frame : segment.frames)
      if (frame.asked) same[frame.frame] = frame.picture;
  return same;
}

std::map<std::string, std::string> states(const Plan& plan) {
  std::map<std::string, std::string> files;
  for (const PlanFile& file : state_files(plan)) files[file.name] = file.content;
  return files;
}

/// Names of state files that are new or differ in `after`.
std::vector<std::string> changed(const Plan& before, const Plan& after) {
  const std::map<std::string, std::string> old = states(before);
  std::vector<std::string> names;
  for (const auto& [name, content] : states(after))
    if (!old.contains(name) || old.at(name) != content) names.push_back(name);
  return names;
}

using Lit = std::map<int, int>;
using Names = std::vector<std::string>;

TEST(Plan, AStillSceneIsLitOnceOverAllSegments) {
  const Plan plan = plan_of(still_room(), {0, 1, 2, 3, 4, 5}, 2);
  EXPECT_EQ(plan.segments.size(), 3u);
  EXPECT_EQ(lit_frames(plan), (Lit{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}));
}

TEST(Plan, OnlyTheCameraMovesAndTheLightIsShared) {
  Scene scene = still_room();
  slide(scene, kCamera, {0, 1, 2, 2});
  const Plan plan = plan_of(scene, {0, 1, 2, 3});
  ASSERT_EQ(plan.segments.size(), 1u);
  EXPECT_EQ(lit_frames(plan), (Lit{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
  EXPECT_TRUE(plan.segments[0].camera_moves);
  EXPECT_NE(plan.segments[0].frames[1].camera, plan.segments[0].frames[2].camera);
  EXPECT_EQ(plan.segments[0].frames[2].camera, plan.segments[0].frames[3].camera);
  ASSERT_EQ(plan.segments[0].moves.size(), 1u);
  EXPECT_EQ(plan.segments[0].moves[0].carries, "camera");
}

TEST(Plan, ABoxThatComesBackIsLitByTheSamePhotons) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0});
  const Plan plan = plan_of(scene, {0, 1, 2, 3});
  EXPECT_EQ(lit_frames(plan), (Lit{{0, 0}, {1, 1}, {2, 1}, {3, 0}}));
  EXPECT_EQ(plan.segments[0].moves[0].why, "translation of Box");
}

TEST(Plan, FramesOfEqualLightAndCameraShowTheSamePicture) {
  Scene scene = still_room();
  EXPECT_EQ(pictures(plan_of(scene, {1, 2, 3}, 2)), (Lit{{1, 1}, {2, 1}, {3, 1}}));  // not 0: nobody asked for it
  slide(scene, kBox, {0, 1, 1, 0, 0});
  EXPECT_EQ(pictures(plan_of(scene, {0, 1, 2, 3, 4})), (Lit{{0, 0}, {1, 1}, {2, 1}, {3, 0}, {4, 0}}));
  slide(scene, kCamera, {0, 0, 1, 0, 2});
  EXPECT_EQ(pictures(plan_of(scene, {0, 1, 2, 3, 4})), (Lit{{0, 0}, {1, 1}, {2, 2}, {3, 0}, {4, 4}}));
}

TEST(Plan, SegmentsWithOtherBoundsShareNoPhotons) {
  Scene scene = still_room();  // frames 0 and 2 look alike, but photons are distributed for the whole segment
  slide(scene, kBox, {0, 1, 0, 50});
  EXPECT_EQ(lit_frames(plan_of(scene, {0, 1, 2, 3}, 2)), (Lit{{0, 0}, {1, 1}, {2, 2}, {3, 3}}));
  scene.animations.clear();
  slide(scene, kBox, {0, 1, 0, 1});
  EXPECT_EQ(lit_frames(plan_of(scene, {0, 1, 2, 3}, 2)), (Lit{{0, 0}, {1, 1}, {2, 0}, {3, 1}}));
}

TEST(Plan, AnAnimationOfEqualKeysMovesNothing) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 0, 0, 0});
  const Plan plan = plan_of(scene, {0, 1, 2, 3});
  EXPECT_TRUE(plan.segments[0].moves.empty());
  EXPECT_EQ(lit_frames(plan), (Lit{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
}

TEST(Plan, WithinASegmentTheRangeAskedForDoesNotChangeWherePhotonsAreTraced) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0});
  EXPECT_EQ(lit_frames(plan_of(scene, {2, 3})), (Lit{{2, 1}, {3, 0}}));
  const Names none;
  EXPECT_EQ(changed(plan_of(scene, {0, 1, 2, 3}), plan_of(scene, {2, 3})), none);
}

TEST(Plan, FramesBeyondTheAnimationShowItsNearestEnd) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3});
  const Plan plan = plan_of(scene, {-2, 0, 3, 9}, 2);
  EXPECT_EQ(lit_frames(plan), (Lit{{-2, 0}, {0, 0}, {3, 3}, {9, 3}}));
  EXPECT_EQ(plan.segments.size(), 2u);
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_EQ(plan.warnings[0], "2 frames outside the animation: the nearest end is shown");
}

TEST(Plan, TheOrderOfTheRangeIsKeptAndDuplicatesAreNot) {
  EXPECT_EQ(plan_of(still_room(), {3, 1, 3, 0}).frames, (std::vector<int>{3, 1, 0}));
}

TEST(Plan, MovingTheLampInOneFrameChangesTheStateOfThatFrameOnly) {
  Scene before = still_room(), after = still_room();
  slide(before, kLamp, {0, 0.1, 0.2, 0.3, 0.4});
  slide(after, kLamp, {0, 0.1, 0.25, 0.3, 0.4});
  const std::vector<int> frames{0, 1, 2, 3, 4};
  EXPECT_EQ(changed(plan_of(before, frames), plan_of(after, frames)), Names{"state/lights.0002"});
}

TEST(Plan, MovingTheCameraChangesStatesOfTheCameraOnly) {
  Scene moved = still_room();
  moved.nodes[kCamera].translation.y = 1;
  EXPECT_EQ(changed(plan_of(still_room(), {0, 1}), plan_of(moved, {0, 1})),
            (Names{"state/camera.0000", "state/camera.0001"}));
}

TEST(Plan, ChangingAMaterialChangesMaterialsAndWhatStands) {
  Scene darker = still_room();
  darker.materials[0].base_color = Rgb(0.25f);
  EXPECT_EQ(changed(plan_of(still_room(), {0}), plan_of(darker, {0})),
            (Names{"state/materials.0000", "state/standing.0000"}));
}

TEST(Plan, CausticPhotonsAreTracedOnlyWhereSomethingMirrors) {
  Scene scene = still_room();
  EXPECT_EQ(plan_of(scene, {0}).photon_kinds, "indirect");
  scene.materials.push_back(matte("mirror", 1));
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0;
  EXPECT_EQ(plan_of(scene, {0}).photon_kinds, "indirect") << "no triangle has the mirror";
  scene.meshes[1].primitives[0].material = 1;
  EXPECT_EQ(plan_of(scene, {0}).photon_kinds, "caustic,indirect");
}

TEST(Plan, NoLambertSurfaceNoPhotons) {
  Scene scene = still_room();
  scene.materials[0].metallic = 1;
  const Plan plan = plan_of(scene, {0});
  EXPECT_EQ(plan.photon_kinds, "");
  EXPECT_FALSE(plan.stages[0].needed);
  EXPECT_EQ(plan.stages[0].because, "0 of 1 material reflect by a Lambert lobe");
  EXPECT_NE(plan_makefile(plan, "plan", {}).find("plan_photons :=\n"), std::string::npos);
}

TEST(Plan, LightFollowsFromWhatStandsWhereASegmentHasStatesEnough) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3, 4, 5});
  // Segments of four frames: 0 to 3 have four states, 4 and 5 two, and from 5 on the animation is over.
  Plan plan = plan_of(scene, {0, 1, 2, 3, 4, 5}, 4);
  const UpdatableLight light = updatable_light(plan);
  EXPECT_EQ(light.segments, 1u);
  EXPECT_EQ(light.states, 4u);
  EXPECT_EQ(light.frame, 2);
  use_moving(plan, "records", "a test");
  EXPECT_EQ(plan.moving, "records");
  EXPECT_TRUE(plan.segments[0].updated);
  EXPECT_FALSE(plan.segments[1].updated);
  const std::string text = plan_makefile(plan, "plan", {});
  EXPECT_NE(text.find("plan_moving := records\n"), std::string::npos);
  EXPECT_NE(text.find("stands_0003 := 0000\n"), std::string::npos);
  EXPECT_EQ(text.find("stands_0004"), std::string::npos);
  EXPECT_NE(text.find("state_0000 := $(addprefix plan/state/,static.0000 materials.0000 standing.0000 frozen.0000 moving.0000 lights.0000"),
            std::string::npos);
  EXPECT_NE(plan_json(plan, "room.glb", "", "").find("\"moving\": \"records\""), std::string::npos);
}

TEST(Plan, LightIsComputedAnewWhereNothingWouldBeSaved) {
  Scene scene = still_room();
  slide(scene, kCamera, {0, 1, 2, 3});
  Plan still = plan_of(scene, {0, 1, 2, 3});
  EXPECT_EQ(updatable_light(still).segments, 0u);
  use_moving(still, "records", "a test");
  EXPECT_EQ(still.moving, "anew");
  slide(scene, kBox, {0, 1, 2, 3});
  Plan moving = plan_of(scene, {0, 1, 2, 3});
  use_indirect(moving, "gather", "a test");
  use_moving(moving, "records", "a test");
  EXPECT_EQ(moving.moving, "light") << "there are no records";
  Plan kept = plan_of(scene, {0, 1, 2, 3});
  use_moving(kept, "time", "a test");
  EXPECT_EQ(kept.moving, "time");
  EXPECT_TRUE(kept.segments.front().updated);
  use_split(kept, true, "a test");
  EXPECT_TRUE(kept.split) << "samples hold the low part";
  Plan asked = plan_of(scene, {0, 1, 2, 3});
  use_moving(asked, "anew", "a test");
  EXPECT_EQ(plan_makefile(asked, "plan", {}).find("stands_"), std::string::npos);
}

TEST(Plan, BrightPointsAreDividedWherePointsAreRead) {
  Plan plan = plan_of(still_room(), {0});
  EXPECT_EQ(plan_makefile(plan, "plan", {}).find("plan_split"), std::string::npos);
  use_split(plan, true, "a test");
  EXPECT_NE(plan_makefile(plan, "plan", {}).find("plan_split := 1\n"), std::string::npos);
  EXPECT_NE(plan_json(plan, "room.glb", "", "").find("\"split\": true"), std::string::npos);
  Plan asked = plan_of(still_room(), {0});
  use_split(asked, false, "a test");
  EXPECT_FALSE(asked.split);
  EXPECT_EQ(asked.stages[std::size_t(std::ranges::find(asked.stages, "photonmap-split", &Stage::name) - asked.stages.begin())].because, "a test");
  Plan paths = plan_of(still_room(), {0});
  use_indirect(paths, "paths", "a test");
  use_split(paths, true, "a test");
  EXPECT_FALSE(paths.split);
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3});
  Plan moving = plan_of(scene, {0, 1, 2, 3});
  use_moving(moving, "records", "a test");
  use_split(moving, true, "a test");
  EXPECT_FALSE(moving.split);
}

TEST(Plan, ASceneWithoutLightIsRefusedWithTheExportersBox) {
  Scene scene = still_room();
  scene.nodes[kLamp].light = -1;
  scene.lights.clear();
  try {
    plan_of(scene, {0});
    FAIL() << "no exception";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Punctual Lights"), std::string::npos) << error.what();
  }
}

TEST(PlanMakefile, SaysWhichPhotonsHoldForAFrameAndWhatTheyDependOn) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0});
  EXPECT_EQ(plan_makefile(plan_of(scene, {2}), "out/plan", scene.files),
            "# Written by scene-plan; formats/plan/plan.md says what each variable is.\n"
            "plan_frames := 0002\n"
            "plan_pictures := 0002\n"
            "plan_photons := 0001\n"
            "plan_kinds := indirect\n"
            "plan_indirect := records\n"
            "plan_paths := 700000\n"
            "plan_rays := 500\n"
            "plan_moving := anew\n"
            "plan_method := frames\n"
            "plan_lights := 1\n"
            "out/plan/plan.mk: room.glb\n"
            "room.glb:\n"
            "out/plan/plan.mk: data\\ folder/room.bin\n"
            "data\\ folder/room.bin:\n"
            "\n# frames 0 to 3\n"
            "light_0000 := $(addprefix out/plan/state/,"
            "static.0000 materials.0000 frozen.0000 moving.0000 lights.0000)\n"
            "light_0001 := $(addprefix out/plan/state/,"
            "static.0000 materials.0000 frozen.0000 moving.0001 lights.0001)\n"
            "light_0002 := $(addprefix out/plan/state/,"
            "static.0000 materials.0000 frozen.0000 moving.0002 lights.0002)\n"
            "camera_0002 := out/plan/state/camera.0002\n"
            "picture_0002 := 0002\n"
            "photons_0002 := 0001\n"
            "segment_0002 := 0000\n"
            "previous_0002 :=\n"
            "light_0003 := $(addprefix out/plan/state/,"
            "static.0000 materials.0000 frozen.0000 moving.0003 lights.0003)\n"
            "\n# photon maps, and the pictures they light\n"
            "views_0001 := 0002\n");
}

TEST(PlanMakefile, NamesTheCamerasThatOneStateOfLightServes) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0, 0});
  slide(scene, kCamera, {0, 0, 1, 0, 2});
  const std::string text = plan_makefile(plan_of(scene, {0, 1, 2, 3, 4}), "plan", scene.files);
  EXPECT_NE(text.find("plan_pictures := 0000 0001 0002 0004\n"), std::string::npos) << text;
  EXPECT_NE(text.find("views_0000 := 0000 0004\nviews_0001 := 0001 0002\n"), std::string::npos) << text;
}

TEST(PlanMakefile, RefusesAFolderThatMakeCannotName) {
  const Plan plan = plan_of(still_room(), {0});
  for (const char* folder : {"my plan", "a:b", "a%b", "$(x)", "a#b", "a\\b", "a;b"})
    EXPECT_THROW(plan_makefile(plan, folder, {}), InputError) << folder;
}

TEST(PlanJson, GivesFactsAndHashesOfEachFrame) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0});
  const nlohmann::json json = nlohmann::json::parse(plan_json(plan_of(scene, {2}), "room.glb", "history\n"));
  EXPECT_EQ(json["format"], "tempolux plan");
  EXPECT_EQ(json["stages"][0]["because"], "1 frame asked for, 1 state of light transport");
  EXPECT_EQ(json["segments"][0]["moves"][0]["node"], "Box");
  const nlohmann::json& frame = json["segments"][0]["frames"][2];
  EXPECT_EQ(frame["photons"], 1);
  EXPECT_EQ(frame["hashes"]["camera"].get<std::string>().size(), 32u);
  EXPECT_FALSE(json["segments"][0]["frames"][1]["hashes"].contains("camera"));
}

TEST(FrameDigits, HaveAtLeastFourPlaces) {
  EXPECT_EQ(frame_digits(0), "0000");
  EXPECT_EQ(frame_digits(12345), "12345");
  EXPECT_EQ(frame_digits(-5), "-005");
}

}  // namespace
}  // namespace tempolux
