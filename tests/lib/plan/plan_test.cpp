// Plans of a small handmade room with a box that moves. The test's own scene decides which frames are equal.
#include "lib/plan/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/error.h"
#include "lib/plan/decide.h"
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

Plan plan_of(const Scene& scene, const std::vector<int>& frames, int segment_length = 24,
             const std::vector<int>& others = {}) {
  TimeOptions time;
  time.segment_length = segment_length;
  return make_plan(scene, frames, kCamera, time, {}, others);
}

using Numbers = std::map<int, int>;

/// Frame asked for -> first frame of its segment with the same light.
Numbers lit_frames(const Plan& plan) {
  Numbers lit;
  for (const auto& [frame, shown] : plan.shows) lit[frame] = plan.segment_of(shown).at(shown).lit_frame;
  return lit;
}

/// Frame asked for -> first frame of its segment that shows the same.
Numbers pictures(const Plan& plan) {
  Numbers same;
  for (const auto& [frame, shown] : plan.shows) same[frame] = plan.segment_of(shown).at(shown).picture;
  return same;
}

/// The graph of a plan whose segments all have these decisions.
Graph graph_of(Plan plan, const Decisions& decisions, Wish wish = {}, const std::string& tool_version = "1") {
  if (wish.filter == Wish::kAutoFilter) wish.filter = 0;
  for (PlannedSegment& segment : plan.segments) segment.decisions = decisions;
  return make_graph(plan, with_preset(wish), [&](const std::string& tool) { return tool + tool_version; }, {});
}

Decisions records() {
  Decisions d;
  d.kinds = "indirect";
  return d;
}

std::set<std::string> names(const Graph& graph, const std::string& folder = "") {
  std::set<std::string> set;
  for (const GraphFile& file : graph.files)
    if (file.name.starts_with(folder)) set.insert(file.name);
  return set;
}

const GraphFile& file_of(const Graph& graph, const std::string& start) {
  return *std::ranges::find_if(graph.files, [&](const GraphFile& file) { return file.name.starts_with(start); });
}

TEST(Plan, AStillSceneIsOneFrame) {
  const Plan plan = plan_of(still_room(), {0, 1, 5}, 2);
  EXPECT_EQ(plan.segments.size(), 1u);
  EXPECT_EQ(lit_frames(plan), (Numbers{{0, 0}, {1, 0}, {5, 0}}));
  Scene scene = still_room();
  slide(scene, kBox, {0, 0, 0, 0});  // equal keys move nothing
  EXPECT_EQ(lit_frames(plan_of(scene, {0, 1, 2, 3}, 2)), (Numbers{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
  EXPECT_TRUE(plan_of(scene, {0}).warnings.empty());
}

TEST(Plan, OnlyTheCameraMovesAndTheLightIsSharedWithinASegment) {
  Scene scene = still_room();
  slide(scene, kCamera, {0, 1, 2, 2});
  const Plan plan = plan_of(scene, {0, 1, 2, 3});
  EXPECT_EQ(lit_frames(plan), (Numbers{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
  EXPECT_EQ(pictures(plan), (Numbers{{0, 0}, {1, 1}, {2, 2}, {3, 2}}));
  EXPECT_EQ(plan.segments[0].moves[0].carries, "camera");
  EXPECT_EQ(lit_frames(plan_of(scene, {0, 1, 2}, 2)), (Numbers{{0, 0}, {1, 0}, {2, 2}}));
}

TEST(Plan, ABoxThatComesBackIsLitByTheSamePhotons) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0});
  const Plan plan = plan_of(scene, {0, 1, 2, 3});
  EXPECT_EQ(lit_frames(plan), (Numbers{{0, 0}, {1, 1}, {2, 1}, {3, 0}}));
  EXPECT_EQ(plan.segments[0].states(), (std::vector<int>{0, 1}));
  EXPECT_EQ(plan.segments[0].moves[0].why, "translation of Box");
}

TEST(Plan, NothingDependsOnTheRangeThatIsAskedFor) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0, 2, 3});
  EXPECT_EQ(lit_frames(plan_of(scene, {2, 3})), (Numbers{{2, 1}, {3, 0}}));
  const Wish wish;
  const std::string key = decision_key(plan_of(scene, {2}).segments[0], wish, false);
  EXPECT_EQ(key, decision_key(plan_of(scene, {0, 1, 2, 3, 4, 5}).segments[0], wish, false));
}

/// First frames of the segments that stand for the shot.
std::vector<int> pieces_of(const Plan& plan) {
  std::vector<int> firsts;
  for (const PlannedSegment& piece : plan.shot) firsts.push_back(piece.first);
  return firsts;
}

TEST(Plan, TheShotIsTheAnimationWhateverIsAskedFor) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(pieces_of(plan_of(scene, {5}, 2)), (std::vector<int>{0, 4, 8}));
  EXPECT_EQ(pieces_of(plan_of(scene, {0, 1, 8}, 2)), (std::vector<int>{0, 4, 8}));
  EXPECT_EQ(pieces_of(plan_of(scene, {5}, 24)), (std::vector<int>{0}));
  EXPECT_EQ(pieces_of(plan_of(still_room(), {5}, 2)), (std::vector<int>{0}));
}

TEST(Plan, FramesOutsideTheAnimationShowItsNearestEnd) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3});
  const Plan plan = plan_of(scene, {-2, 0, 3, 9}, 2);
  EXPECT_EQ(lit_frames(plan), (Numbers{{-2, 0}, {0, 0}, {3, 3}, {9, 3}}));
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_EQ(plan.warnings[0],
            "of the frames asked for -2, 9 are outside the animation (0 to 3): its nearest end is shown");
}

TEST(Plan, TheOrderOfTheRangeIsKeptAndDuplicatesAreNot) {
  EXPECT_EQ(plan_of(still_room(), {3, 1, 3, 0}).frames, (std::vector<int>{3, 1, 0}));
}

TEST(Plan, CausticPhotonsAreTracedOnlyWhereSomethingMirrors) {
  Scene scene = still_room();
  EXPECT_TRUE(plan_of(scene, {0}).segments[0].materials.lambert);
  scene.materials.push_back(matte("mirror", 1));
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0;
  EXPECT_FALSE(plan_of(scene, {0}).segments[0].materials.other) << "no triangle has the mirror";
  scene.meshes[1].primitives[0].material = 1;
  EXPECT_TRUE(plan_of(scene, {0}).segments[0].materials.other);
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

TEST(LookedFrames, AreEndsMiddleAndWhereSomethingComesOrGoes) {
  Scene scene = still_room();
  std::vector<double> places(24, 0.0);
  std::fill(places.begin() + 17, places.end(), 5.0);  // stands, jumps, stands
  places.back() = 5.5;
  slide(scene, kBox, places);
  // Frames 0 and 11 show the same picture. The box jumps at frame 17 and moves again at 23.
  EXPECT_EQ(looked_frames(plan_of(scene, {3}).segments[0]), (std::vector<int>{0, 17, 23}));
  EXPECT_EQ(looked_frames(plan_of(scene, {3}).segments[0], true), (std::vector<int>{11, 17, 23}))
      << "a segment of a shot";
}

TEST(Graph, AFrameMadeAloneHasTheFilesThatItHasInARange) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3, 4, 5, 6, 7});
  slide(scene, kCamera, {0, 0, 1, 1, 2, 2, 3, 3});
  std::vector<int> all(8);
  for (int f = 0; f < 8; ++f) all[std::size_t(f)] = f;
  for (const MovingMethod moving : {MovingMethod::anew, MovingMethod::light, MovingMethod::records, MovingMethod::time})
    for (const int filter : {0, 3})
      for (const FrameMethod method : {FrameMethod::frames, FrameMethod::walkthrough}) {
        if (filter > 0 && method != FrameMethod::frames) continue;
        Decisions d = records();
        d.moving = moving;
        Wish wish;
        wish.filter = filter;
        wish.method = method;
        wish.key_distance = 4;
        const Graph range = graph_of(plan_of(scene, all, 4, helper_frames(all, wish)), d, wish);
        const Graph alone = graph_of(plan_of(scene, {5}, 4, helper_frames({5}, wish)), d, wish);
        EXPECT_EQ(alone.pictures.at(5), range.pictures.at(5)) << int(moving) << ' ' << filter << ' ' << int(method);
        const std::set<std::string> more = names(range);
        for (const std::string& name : names(alone)) EXPECT_TRUE(more.contains(name)) << name;
      }
}

// Segments of 4 and of 8 frames with the same bounds: the file of what cameras see has another name, the same content.
TEST(Graph, ANameDoesNotChangeWithTheFirstFrameOfTheSegment) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 3, 1, 2, 0, 1.5, 3, 0.5});
  Decisions d = records();
  d.view = "tempolux view 1.0\n1 2 3 4 5\n";
  const Graph four = graph_of(plan_of(scene, {5}, 4), d), eight = graph_of(plan_of(scene, {5}, 8), d);
  EXPECT_NE(four.states[0].name, eight.states[0].name);
  for (const char* folder : {"photons", "points", "cache", "pictures"})
    EXPECT_EQ(names(four, folder), names(eight, folder)) << folder;
  d.view = "tempolux view 1.0\n1 2 3 4 6\n";
  EXPECT_NE(names(graph_of(plan_of(scene, {5}, 8), d), "photons"), names(eight, "photons"));
}

// The box slides as far in both segments, so their static scenes and bounds are equal.
TEST(Graph, SegmentsWithTheSameStaticSceneShareItsLight) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 3, 1, 2, 0, 1.5, 3, 0.5});
  Decisions d = records();
  d.moving = MovingMethod::records;
  const Graph graph = graph_of(plan_of(scene, {1, 5}, 4), d);
  EXPECT_EQ(names(graph, "stands/").size(), 1u);
  EXPECT_EQ(names(graph, "stands_points/").size(), 1u);
  EXPECT_EQ(names(graph, "touched/").size(), 2u);
  // Alone, the second segment makes the same files.
  EXPECT_EQ(names(graph_of(plan_of(scene, {5}, 4), d), "stands/"), names(graph, "stands/"));
}

TEST(Graph, AnEditOfAMoverRemakesNoStaticLightAndNoOtherFrame) {
  Scene scene = still_room(), edited = still_room();
  slide(scene, kBox, {0, 3, 1, 2, 0, 1.5, 3, 0.5});
  slide(edited, kBox, {0, 3, 1, 2, 0, 1.25, 3, 0.5});
  Decisions d = records();
  d.moving = MovingMethod::light;
  const std::vector<int> all{0, 1, 2, 3, 4, 5, 6, 7};
  const Graph before = graph_of(plan_of(scene, all, 4), d), after = graph_of(plan_of(edited, all, 4), d);
  for (const char* folder : {"stands/", "stands_points/"}) EXPECT_EQ(names(before, folder), names(after, folder));
  std::set<std::string> made;
  for (const std::string& name : names(after))
    if (!names(before).contains(name)) made.insert(name.substr(0, name.find('-')));
  EXPECT_EQ(made, (std::set<std::string>{"touched/0004", "moved/0005", "points/0005", "cache/0005", "pictures/0005"}));
}

TEST(Graph, ANameChangesWithAllThatTheFileIsMadeFromAndWithNothingElse) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2});
  const Graph graph = graph_of(plan_of(scene, {0, 1}), records());
  const auto same = [&](const Graph& other, const char* folder) {
    return names(graph, folder) == names(other, folder);
  };

  Scene camera = scene;
  camera.nodes[kCamera].translation.y = 1;
  const Graph moved_camera = graph_of(plan_of(camera, {0, 1}), records());
  EXPECT_TRUE(same(moved_camera, "photons") && same(moved_camera, "points"));
  EXPECT_FALSE(same(moved_camera, "cache") || same(moved_camera, "pictures"));

  Scene lamp = scene;
  lamp.lights[0].intensity *= 2;
  EXPECT_FALSE(same(graph_of(plan_of(lamp, {0, 1}), records()), "photons"));

  Wish pixels;
  pixels.pixels = "--spp 8";
  const Graph other_pixels = graph_of(plan_of(scene, {0, 1}), records(), pixels);
  EXPECT_TRUE(same(other_pixels, "cache"));
  EXPECT_FALSE(same(other_pixels, "pictures"));

  EXPECT_FALSE(same(graph_of(plan_of(scene, {0, 1}), records(), {}, "2"), "photons")) << "another program";
  Wish draft;
  draft.quality = Quality::draft;
  EXPECT_FALSE(same(graph_of(plan_of(scene, {0, 1}), records(), draft), "pictures"));
}

/// Meant to catch: records whose key holds the whole camera (cameras() in place of pinholes()).
TEST(Graph, AnEditOfTheLensRendersFramesAgainAndNothingElse) {
  Scene scene = still_room();
  const std::set<std::string> sharp = names(graph_of(plan_of(scene, {0}), records()));
  CameraExtras& extras = scene.nodes[kCamera].camera_extras;
  extras.set(&Camera::f_stop, 2);
  extras.set(&Camera::focus_m, 3);
  for (const std::string& name : names(graph_of(plan_of(scene, {0}), records())))
    EXPECT_EQ(sharp.contains(name),
              !name.starts_with("pictures/") && !name.starts_with("raw/") && !name.starts_with("filtered/"))
        << name;
}

/// A focus that moves makes pictures of a room where nothing else moves; all of them read the same records.
TEST(Graph, PicturesOfAFocusPullShareTheirRecords) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 0, 0, 0});
  CameraExtras& extras = scene.nodes[kCamera].camera_extras;
  extras.set(&Camera::f_stop, 2);
  extras.set(&Camera::focus_m, 3);
  for (std::vector<double>& list : extras.lists)
    if (list == std::vector{3.0}) list = {3, 4, 5, 5};
  const Plan plan = plan_of(scene, {0, 1, 2, 3});
  EXPECT_EQ(pictures(plan), (Numbers{{0, 0}, {1, 1}, {2, 2}, {3, 2}}));
  EXPECT_EQ(names(graph_of(plan, records()), "cache/").size(), 1u);
  Wish walk;
  walk.method = FrameMethod::walkthrough;
  EXPECT_THROW(graph_of(plan, records(), walk), InputError);
}

TEST(Graph, RecordsOverTimeFollowFromTheStateBeforeInTheSegmentOnly) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3, 4, 5, 6, 7});
  Decisions d = records();
  d.moving = MovingMethod::time;
  const Graph graph = graph_of(plan_of(scene, {2, 5}, 4), d);
  EXPECT_NE(file_of(graph, "kept/0002").words.find("--previous kept/0001-"), std::string::npos);
  EXPECT_NE(file_of(graph, "kept/0005").words.find("--previous kept/0004-"), std::string::npos);
  EXPECT_EQ(file_of(graph, "kept/0004").words.find("--previous"), std::string::npos);
}

TEST(Graph, WhatIsNotNeededIsNotThere) {
  const Plan plan = plan_of(still_room(), {0});
  Decisions paths;
  paths.indirect = IndirectMethod::paths;
  EXPECT_EQ(graph_of(plan, paths).files.size(), 1u);
  Decisions gather = records();
  gather.indirect = IndirectMethod::gather;
  EXPECT_TRUE(names(graph_of(plan, gather), "cache").empty());
  EXPECT_TRUE(names(graph_of(plan, records()), "split").empty());
  Decisions split = records();
  split.split = true;
  EXPECT_NE(file_of(graph_of(plan, split), "cache").words.find("--high split/0000-"), std::string::npos);
}

TEST(Graph, NothingIsWarpedIntoAFrameOfOtherLight) {
  Scene scene = still_room();
  std::vector<double> places(9), lamp(9, 0.0);
  for (std::size_t f = 0; f < 9; ++f) places[f] = double(f);
  lamp[3] = 1;  // the lamp is elsewhere in frame 3
  slide(scene, kCamera, places);
  slide(scene, kLamp, lamp);
  Wish wish;
  wish.method = FrameMethod::walkthrough;
  wish.key_distance = 8;
  const std::vector<int> frames{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const Graph graph = graph_of(plan_of(scene, frames, 24, helper_frames(frames, wish)), records(), wish);
  // 0 to 8 is halved to 0-2 and 4-8; 2-4 holds frame 3.
  EXPECT_TRUE(graph.pictures.at(1).starts_with("walked/"));
  EXPECT_TRUE(graph.pictures.at(5).starts_with("walked/"));
  for (const int key : {0, 2, 3, 4, 8}) EXPECT_TRUE(graph.pictures.at(key).starts_with("keys/")) << key;
}

/// A box moves through frames 0 to 8 while the camera stands until frame 6: frame 4 gives the pixels that stay, with
/// its own light, to the frames until 6. Frame 7 is sampled as a whole. Frame 4 needs no other frame. The segments of
/// frame 4 and of frame 0 differ.
TEST(Graph, StillFramesTakePixelsFromTheMiddleWhileTheCameraStands) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3, 4, 5, 6, 7, 8});
  slide(scene, kCamera, {0, 0, 0, 0, 0, 0, 0, 1, 2});
  Wish wish;
  wish.method = FrameMethod::still;
  wish.filter = 1;
  TimeOptions time;
  time.segment_length = 4;
  const Plan plan = make_plan(scene, std::vector{0, 4, 7}, kCamera, time, {}, {}, {.frames = {}, .with_middle = true});
  ASSERT_EQ(plan.middle(), 4);
  const Graph graph = graph_of(plan, records(), wish);
  ASSERT_EQ(names(graph, "still/").size(), 1u);
  const std::string words = file_of(graph, "raw/0000").words;
  for (const char* part :
       {" --still still/0004-", " --still-frame 4", " --still-irradcache cache/0004-", " --still-points points/0004-"})
    EXPECT_NE(words.find(part), std::string::npos) << part << " in " << words;
  EXPECT_EQ(file_of(graph, "raw/0007").words.find("--still"), std::string::npos);
  EXPECT_NE(file_of(graph, "filtered/0004").words.find("still/0004-"), std::string::npos);
  wish.method = FrameMethod::automatic;
  EXPECT_TRUE(names(graph_of(plan, records(), wish), "still/").empty()) << "METHOD=auto where it does not pay";
  Decisions pays = records();
  pays.still = true;
  EXPECT_EQ(names(graph_of(plan, pays, wish), "still/").size(), 1u) << "METHOD=auto where it pays";
}

/// The shot is the whole animation, or the frames that are asked for: its first, middle and last frame stand for it,
/// whatever frames are rendered.
TEST(Plan, TheShotIsTheAnimationOrWhatIsAskedFor) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  TimeOptions time;
  time.segment_length = 2;
  const auto pieces = [&](std::vector<int> frames, const ShotWish& shot) {
    const Plan plan = make_plan(scene, frames, kCamera, time, {}, {}, shot);
    std::vector<int> found{plan.shot_frames[0], plan.shot_frames[1]};
    for (const PlannedSegment& piece : plan.shot) found.push_back(piece.first);
    return found;
  };
  EXPECT_EQ(pieces({3}, {}), (std::vector{0, 11, 0, 4, 10}));
  EXPECT_EQ(pieces({3}, {.frames = {{4, 9}}}), (std::vector{4, 9, 4, 6, 8}));
  EXPECT_EQ(pieces({5, 8}, {.frames = {{4, 9}}}), (std::vector{4, 9, 4, 6, 8}));
  EXPECT_EQ(pieces({3}, {.frames = {{10, 99}}}), (std::vector{10, 11, 10})) << "clamped to the animation";
  EXPECT_EQ(make_plan(scene, std::vector{5}, kCamera, time, {}, {}, {.frames = {{4, 9}}, .with_middle = true}).middle(),
            6);
}

/// An interval is halved by what a viewer sees where pictures of its quality have more errors than allowed.
TEST(Graph, AnIntervalMayShowWhatItsQualityShows) {
  for (const auto& [quality, own, words] :
       {std::tuple{Quality::draft, -1.0, " 20% "}, {Quality::final, -1.0, " 5% "}, {Quality::draft, 0.0, " 0% "}}) {
    Scene scene = still_room();
    slide(scene, kCamera, {0, 1, 2, 3, 4});
    Wish wish;
    wish.method = FrameMethod::walkthrough;
    wish.key_distance = 4;
    wish.quality = quality;
    wish.threshold = own;
    const std::vector<int> frames{0, 1, 2, 3, 4};
    const Graph graph = graph_of(plan_of(scene, frames, 24, helper_frames(frames, wish)), records(), wish);
    int intervals = 0;
    for (const auto& file : graph.files)
      if (file.name.starts_with("walk/")) {
        EXPECT_NE(file.words.find(words), std::string::npos) << file.words;
        ++intervals;
      }
    EXPECT_GT(intervals, 0);
  }
}

/// Frames 0 to 3 of eight, with windows of three: picture 3 is also in the window of frame 4, which is not asked for.
TEST(Graph, ARawPictureIsRemovedIfAllFramesWhoseWindowsHoldItAreAskedFor) {
  Scene scene = still_room();
  slide(scene, kCamera, {0, 1, 2, 3, 4, 5, 6, 7});
  Wish wish;
  wish.filter = 3;
  const Plan plan = plan_of(scene, {0, 1, 2, 3}, 8, helper_frames({0, 1, 2, 3}, wish));
  const Graph graph = make_graph(plan, with_preset(wish), [](const std::string& tool) { return tool; }, {});
  for (const char* name : {"raw/0000", "raw/0001", "raw/0002"}) EXPECT_TRUE(file_of(graph, name).passing) << name;
  for (const char* name : {"raw/0003", "raw/0004"}) EXPECT_FALSE(file_of(graph, name).passing) << name;
}

/// The words of a filtered frame's raw picture are frame-render's own: the frame, its light, the preset's samples and
/// error, and the channels from which st-filter makes those of the wish.
TEST(Graph, ARawPictureHasTheWordsOfItsPresetAndItsFilter) {
  Wish wish;
  wish.filter = 1;
  wish.channels = "RGBA,P";
  Decisions decisions = records();
  decisions.pixel_error = 0.016;
  const Graph graph = graph_of(plan_of(still_room(), {0}), decisions, wish);
  const std::string words = " " + file_of(graph, "raw/").words + " ";
  for (const char* expected : {" --frame 0 ", " --irradcache cache/", " --points points/", " --size 640x360 ",
                               " --spp 4 ", " --pixel-error 0.016 ", " --compression none ",
                               " --channels RGBA,layers,Z,N,id,albedo,coverage,halves,seen,P ", " --audit 0.02 "})
    EXPECT_NE(words.find(expected), std::string::npos) << expected << "is missing in" << words;
  EXPECT_EQ(words.find(" --seed-mode "), std::string::npos) << "a frame that is filtered alone";
  wish.pixels = "--spp 9";  // the user's words replace the preset's
  const Graph own = graph_of(plan_of(still_room(), {0}), decisions, wish);
  const std::string replaced = " " + file_of(own, "raw/").words + " ";
  EXPECT_NE(replaced.find(" --spp 9 "), std::string::npos) << replaced;
  EXPECT_EQ(replaced.find(" --pixel-error "), std::string::npos) << replaced;
}

TEST(PlanFiles, NoWordOfTheSceneReachesMake) {
  Scene scene = still_room();
  scene.path = "$(shell touch X).glb";
  scene.nodes[kBox].name = scene.materials[0].name = "$(shell touch X)";
  slide(scene, kBox, {0, 1, 2});
  const Plan plan = plan_of(scene, {0, 1});
  const std::string text = plan_makefile(plan, graph_of(plan, records()), [](const std::string& tool) { return tool; });
  EXPECT_EQ(text.find("touch"), std::string::npos);
  EXPECT_NE(text.find("frames := frames/0000.exr frames/0001.exr\n"), std::string::npos);
}

PlanContext of_room(const std::string& scene) {
  return {scene, {"--fps=30"}, "a camera", {"--f-stop=2"}, table_costs(640, 360), "history\n"};
}

TEST(PlanFiles, JsonHasTheWholeCommandOfEachFile) {
  const Plan plan = plan_of(still_room(), {0});
  const Graph graph = graph_of(plan, records());
  const std::string text = plan_json(plan, graph, of_room("/a \"b\"\xc3\xa9/\xff.glb"));
  EXPECT_NE(text.find("\"/a \\\"b\\\"\\udcc3\\udca9/\\udcff.glb\", "), std::string::npos) << text;
  const PlanContext context = of_room("/a/room.glb");
  const nlohmann::json files = nlohmann::json::parse(plan_json(plan, graph, context))["files"];
  ASSERT_EQ(files.size(), graph.files.size());
  const GraphFile& cache = file_of(graph, "cache/");
  const auto found = std::ranges::find_if(files, [&](const nlohmann::json& one) { return one["file"] == cache.name; });
  const std::vector<std::string> argv = (*found)["argv"];
  EXPECT_EQ(argv, command_of(cache, context));
  EXPECT_EQ((std::vector(argv.begin(), argv.begin() + 3)),
            (std::vector<std::string>{"irradcache-build", "records", "/a/room.glb"}));
  EXPECT_EQ((std::vector(argv.end() - 8, argv.end())),
            (std::vector<std::string>{"--fps=30", "--camera", "a camera", "--f-stop=2", "-o", cache.name, "--stats",
                                      beside(cache.name, ".json")}));
  EXPECT_EQ((*found)["inputs"], cache.inputs);
}

TEST(PlanFiles, EachStageHasItsOwnFolderAndName) {
  std::set<std::string_view> folders, names;
  for (const StageInfo& stage : kStages) {
    folders.insert(stage.folder);
    names.insert(stage.name);
  }
  EXPECT_EQ(folders.size(), kStages.size());
  EXPECT_EQ(names.size(), kStages.size());
}

TEST(PlanFiles, JsonGivesFactsAndHashesOfEachFrame) {
  Scene scene = still_room();
  slide(scene, kBox, {0, 1, 1, 0});
  const Plan plan = plan_of(scene, {2});
  const nlohmann::json json = nlohmann::json::parse(plan_json(plan, graph_of(plan, records()), of_room("room.glb")));
  EXPECT_EQ(json["format"], "tempolux plan");
  EXPECT_EQ(json["segments"][0]["moves"][0]["node"], "Box");
  EXPECT_EQ(json["segments"][0]["frames"][2]["lit_as"], 1);
  EXPECT_EQ(json["segments"][0]["frames"][2]["hashes"]["camera"].get<std::string>().size(), 32u);
  EXPECT_TRUE(json["pictures"]["0002"].get<std::string>().starts_with("pictures/0001-")) << "shows what frame 1 shows";
}

TEST(PlanFiles, DecisionsAreReadBackAsTheyWere) {
  Decisions d = records();
  d.moving = MovingMethod::light;
  d.new_share = 0.125;
  d.together = 8;
  d.photon_paths = 12345678901;
  d.view = "tempolux view 1.0\n1 2 3 4 5\n";
  d.looked = {0, 5};
  d.reasons = {{"photonmap-split", "a test"}};
  const std::string text = decisions_text(d);
  EXPECT_EQ(decisions_text(read_decisions(text)), text);
  EXPECT_THROW(read_decisions("{}"), InputError);
}

TEST(FrameDigits, HaveAtLeastFourPlaces) {
  EXPECT_EQ(frame_digits(0), "0000");
  EXPECT_EQ(frame_digits(12345), "12345");
  EXPECT_EQ(frame_digits(-5), "-005");
}

}  // namespace
}  // namespace tempolux
