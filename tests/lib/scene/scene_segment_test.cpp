// tests/lib/scene/scene_segment_test.cpp -- segments: borders, motion by value, the origin of scene space.
#include <cmath>
#include <stdexcept>

#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

/// One triangle that moves along x over [0, seconds].
Scene moving_for(float seconds) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.animate(0, "translation", {0, seconds}, {0, 0, 0, 1, 0, 0});
  return maker.load();
}

using Borders = std::pair<int, int>;
Borders borders(const Scene& scene, int frame, const TimeOptions& options = {}) {
  const Segment segment = segment_of(scene, frame, options);
  EXPECT_LE(segment.first, frame);
  EXPECT_GE(segment.last, frame);
  return {segment.first, segment.last};
}

TEST(SceneSegment, BordersAreMultiplesCutToTheAnimation) {
  const Scene scene = moving_for(60 / 24.0f);  // frames 0 .. 60
  EXPECT_EQ(borders(scene, 0), Borders(0, 23));
  EXPECT_EQ(borders(scene, 23), Borders(0, 23));
  EXPECT_EQ(borders(scene, 24), Borders(24, 47));
  EXPECT_EQ(borders(scene, 48), Borders(48, 60));
  EXPECT_EQ(borders(scene, 60), Borders(48, 60));
  EXPECT_EQ(borders(scene, 61), Borders(61, 71));  // after the end: everything holds its last state
  EXPECT_EQ(borders(scene, 100), Borders(96, 119));
  EXPECT_EQ(borders(scene, -1), Borders(-24, -1));
  EXPECT_EQ(borders(scene, -24), Borders(-24, -1));
  EXPECT_EQ(borders(scene, 10, {.segment_length = 8}), Borders(8, 15));
}

TEST(SceneSegment, FramesOutsideTheAnimationStandForItsEnds) {
  const Scene scene = moving_for(60 / 24.0f);
  EXPECT_EQ(frame_in_animation(scene, -3, {}), 0);
  EXPECT_EQ(frame_in_animation(scene, 60, {}), 60);
  EXPECT_EQ(frame_in_animation(scene, 61, {}), 60);
  EXPECT_EQ(frame_in_animation(moving_for(10.5f / 24), 12, {}), 11);
}

TEST(SceneSegment, AStillSceneHasSegmentsOfFullLength) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  EXPECT_EQ(borders(maker.load(), 5), Borders(0, 23));
}

TEST(SceneSegment, AnAnimationThatEndsBetweenFramesReachesTheNext) {
  EXPECT_EQ(borders(moving_for(10.5f / 24), 3), Borders(0, 11));
  EXPECT_EQ(borders(moving_for(47 / 24.0f), 30), Borders(24, 47));  // float32 of 47/24 is no 48
}

TEST(SceneSegment, ALongerAnimationMovesNoOtherBorder) {
  EXPECT_EQ(borders(moving_for(2), 5), borders(moving_for(20), 5));
  EXPECT_EQ(borders(moving_for(3), 30), borders(moving_for(20), 30));
}

/// Frames 0 to 24 or 1 to 24 are one segment, not one of 24 frames and one of a single frame.
TEST(SceneSegment, ALastPieceOfLessThanHalfASegmentJoinsTheOneBefore) {
  for (const int frame : {0, 3, 24}) EXPECT_EQ(borders(moving_for(1), frame), Borders(0, 24)) << frame;
  EXPECT_EQ(borders(moving_for(1), 25), Borders(25, 47));  // after the animation
  EXPECT_EQ(borders(moving_for(58 / 24.0f), 30), Borders(24, 58));
  EXPECT_EQ(borders(moving_for(58 / 24.0f), 50), Borders(24, 58));
  EXPECT_EQ(borders(moving_for(58 / 24.0f), 5), Borders(0, 23));
  EXPECT_EQ(borders(moving_for(59 / 24.0f), 50), Borders(48, 59));  // half a segment stands alone
}

TEST(SceneSegment, WhatMovesIsDecidedByValueWithinTheSegment) {
  GltfMaker maker;
  for (int i = 0; i < 3; ++i)
    maker.add_node({{"name", std::string(1, char('A' + i))}, {"mesh", i == 0 ? maker.add_triangle() : 0}});
  maker.animate(0, "translation", {0, 1, 2, 3}, {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0});  // only from 1 s to 2 s
  maker.animate(1, "translation", {0, 3}, {4, 5, 6, 4, 5, 6});                          // equal keys
  const Scene scene = maker.load();
  EXPECT_EQ(segment_of(scene, 0, {}).node_moves, (std::vector<std::uint8_t>{0, 0, 0}));
  const Segment middle = segment_of(scene, 30, {});
  EXPECT_EQ(middle.node_moves, (std::vector<std::uint8_t>{1, 0, 0}));
  EXPECT_EQ(middle.why_moves, (std::vector<std::string>{"translation of A", "", ""}));
  // At frame 48 = 2 s the last state is reached, although the key's float32 time need not be 48/24 exactly.
  EXPECT_EQ(segment_of(scene, 50, {}).node_moves, (std::vector<std::uint8_t>{0, 0, 0}));
}

TEST(SceneSegment, MotionEndsAtItsLastKeyWhateverTheRoundingOfItsTime) {
  for (const int end : {24, 25, 31, 47}) {
    GltfMaker maker;
    maker.add_node({{"mesh", maker.add_triangle()}});
    maker.animate(0, "translation", {0, float(end / 24.0), 4}, {0, 0, 0, 1, 0, 0, 1, 0, 0});
    const TimeOptions options{.segment_length = 1};
    const Scene scene = maker.load();
    const std::vector<Affine> at_end = world_from_node(scene, end, options),
                              later = world_from_node(scene, end + 1, options);
    EXPECT_EQ(at_end, later) << end;
  }
}

TEST(SceneSegment, DescendantsOfWhatMovesMove) {
  GltfMaker maker;
  const int child = maker.add_node({{"name", "Child"}, {"mesh", maker.add_triangle()}}, false);
  const int parent = maker.add_node({{"name", "Parent"}, {"children", {child}}});
  maker.add_node({{"name", "Other"}, {"mesh", 0}});
  maker.animate(parent, "rotation", {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0});
  const Segment segment = segment_of(maker.load(), 0, {});
  EXPECT_EQ(segment.node_moves, (std::vector<std::uint8_t>{1, 1, 0}));
  EXPECT_EQ(segment.why_moves[1], "parent Parent");
}

TEST(SceneSegment, ASpinningCounterRotationStandsStill) {
  // The child undoes its parent's translation: its world transform never changes, so it is static.
  GltfMaker maker;
  const int child = maker.add_node({{"mesh", maker.add_triangle()}}, false);
  const int parent = maker.add_node({{"children", {child}}});
  maker.animate(parent, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  maker.animate(child, "translation", {0, 1}, {0, 0, 0, -1, 0, 0});
  EXPECT_EQ(segment_of(maker.load(), 0, {}).node_moves, (std::vector<std::uint8_t>{1, 0}));
}

TEST(SceneSegment, AMovingCameraMovesNothingElse) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const Scene scene = load_gltf((shared_scenes() / "made/S4_atrium.glb").string());
  const Segment segment = segment_of(scene, 0, {});
  const std::size_t camera = std::size_t(scene.camera_node("auto"));
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    EXPECT_EQ(segment.node_moves[n], n == camera) << scene.nodes[n].name;
}

TEST(SceneSegment, BoundsHoldTheWholeSegment) {
  const Scene scene = moving_for(1);
  const Segment segment = segment_of(scene, 0, {});
  EXPECT_EQ(segment.world_bounds.lower, (Vec3d{0, 0, 0}));
  EXPECT_NEAR(segment.world_bounds.upper.x, 1 + 24 / 24.0, 1e-7);
  EXPECT_EQ(segment.world_bounds.upper.y, 1);
}

TEST(SceneSegment, StaticSurfacesAreSharedByAllFrames) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const Scene scene = load_gltf((shared_scenes() / "made/S2_cornell_moving.glb").string());
  const SegmentScene stage(scene, segment_of(scene, 0, {}), {});
  const SceneFrame a = stage.at(0), b = stage.at(23);
  ASSERT_EQ(a.static_count, 8u);
  for (std::size_t s = 0; s < a.static_count; ++s)
    EXPECT_EQ(a.surfaces[s].positions.data(), b.surfaces[s].positions.data());
  EXPECT_NE(a.surfaces[8].positions.data(), b.surfaces[8].positions.data());
  EXPECT_THROW(stage.at(24), std::invalid_argument);
}

// ---- far from the origin ----------------------------------------------------------------------------------

/// A box of 1 m whose near corner is at `where`, placed by its node.
Scene box_at(double x, double y, double z) {
  GltfMaker maker;
  std::vector<float> corners;
  for (int c = 0; c < 8; ++c)
    for (int axis = 0; axis < 3; ++axis) corners.push_back(float(c >> axis & 1));
  const int positions = maker.add_vec3(corners);
  const int indices = maker.add_indices(
      {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
  const double a = 0.3;  // turned about y, so that coordinates are no round numbers
  maker.add_node({{"mesh", maker.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})},
                  {"translation", {x, y, z}},
                  {"rotation", {0, std::sin(a / 2), 0, std::cos(a / 2)}}});
  maker.add_light({{"type", "point"}}, {{"translation", {x, y + 2, z}}});
  maker.add_camera({{"translation", {x, y, z + 5}}});
  return maker.load();
}

TEST(SceneOrigin, ABoxFarAwayKeepsItsShape) {
  const double x = 1e5 + 0.1, y = 0.2, z = -1e5 + 0.3;
  const Scene scene = box_at(x, y, z);
  const SceneFrame at = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
  EXPECT_NE(at.origin.x, 0);
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (int k = 0; k < 8; ++k) {
    const double lx = k & 1, ly = k >> 1 & 1, lz = k >> 2 & 1;
    const Vec3d world{x + c * lx + s * lz, y + ly, z - s * lx + c * lz};
    // scene space is below 8 m here: half an ulp is 2.4e-7 m. Without the origin it would be 4e-3 m.
    EXPECT_NEAR_VEC(at.origin + Vec3d(at.surfaces[0].positions[std::size_t(k)]), world, 3e-7);
  }
  EXPECT_NEAR_VEC(at.origin + Vec3d(at.lights[0].position), (Vec3d{x, y + 2, z}), 3e-7);
  EXPECT_NEAR_VEC(at.origin + at.camera(scene.camera_node("auto")).scene_from_camera.translation, (Vec3d{x, y, z + 5}),
                  1e-9);
}

TEST(SceneOrigin, IsZeroForAnOrdinaryScene) {
  for (const double x : {0.0, 10.0, 100.0}) {
    const Scene scene = box_at(x, 0, 0);
    EXPECT_EQ(segment_of(scene, 0, {}).origin, Vec3d{}) << x;
  }
  // a turned unit box is sqrt(1.25^2 2 + 1) = 2.03 m across, so from 64 x 2.03 = 130 m on it has its own
  EXPECT_NE(segment_of(box_at(140, 0, 0), 0, {}).origin, Vec3d{});
}

TEST(SceneOrigin, StaysWhereItIsWhenTheSceneChangesALittle) {
  const Vec3d origin = segment_of(box_at(1e5, 0, 0), 0, {}).origin;
  EXPECT_EQ(segment_of(box_at(1e5 + 0.5, 0.5, 0.5), 0, {}).origin, origin);
  EXPECT_EQ(std::fmod(origin.x, 16), 0);  // four diagonals rounded up: 16 m
}

}  // namespace
}  // namespace tempolux
