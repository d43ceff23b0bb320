// tests/lib/scene/scene_animation_test.cpp -- where things are at a frame, against values worked out by hand.
#include <cmath>
#include <numbers>

#include "lib/scene/animate.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/scene_at_frame.h"

namespace tempolux {
namespace {

constexpr float kHalf = 0.70710678f;  // sin and cos of 45 degrees

/// A triangle whose node is animated; x(frame) is where its corner (1,0,0) stands.
struct Animated {
  GltfMaker maker;
  Animated(const char* path, const std::vector<float>& times, const std::vector<float>& values,
           const char* how = "LINEAR") {
    maker.add_node({{"mesh", maker.add_triangle()}});
    maker.animate(0, path, times, values, how);
  }
  Vec3 corner(int frame, double fps = 24) const {
    const Scene scene = maker.load();
    const TimeOptions options{.fps = fps};
    return scene_at_frame(scene, segment_of(scene, frame, options), frame, options).surfaces[0].positions[1];
  }
};

// Tolerance: float32 keys and one rounding of a coordinate below 4 m: 4 x 2^-24 = 2.4e-7.
constexpr double kRounding = 5e-7;

TEST(SceneAnimation, LinearTranslationAtFOverFps) {
  const Animated moved("translation", {0, 1}, {0, 0, 0, 1, 2, 3});
  EXPECT_NEAR_VEC(moved.corner(6), (Vec3{1.25f, 0.5f, 0.75f}), kRounding);
  EXPECT_NEAR_VEC(moved.corner(6, 30), (Vec3{1.2f, 0.4f, 0.6f}), kRounding);
}

TEST(SceneAnimation, OutsideItsKeysATrackHoldsTheFirstOrLast) {
  const Animated moved("translation", {0.5f, 1}, {1, 0, 0, 2, 0, 0});
  EXPECT_EQ(moved.corner(0), (Vec3{2, 0, 0}));
  EXPECT_EQ(moved.corner(-5), (Vec3{2, 0, 0}));
  EXPECT_EQ(moved.corner(24), (Vec3{3, 0, 0}));
  EXPECT_EQ(moved.corner(1000), (Vec3{3, 0, 0}));
}

TEST(SceneAnimation, StepHoldsUntilTheNextKey) {
  const Animated moved("translation", {0, 0.5f, 1}, {0, 0, 0, 1, 0, 0, 2, 0, 0}, "STEP");
  EXPECT_EQ(moved.corner(11).x, 1);
  EXPECT_EQ(moved.corner(12).x, 2);
  EXPECT_EQ(moved.corner(23).x, 2);
  EXPECT_EQ(moved.corner(24).x, 3);
}

TEST(SceneAnimation, RotationGoesAtConstantSpeedAlongTheArc) {
  // a quarter turn about y in one second: the corner (1,0,0) is at (cos a, 0, -sin a)
  const Animated turned("rotation", {0, 1}, {0, 0, 0, 1, 0, kHalf, 0, kHalf});
  for (const int frame : {4, 8, 12, 20}) {
    const double a = std::numbers::pi / 2 * frame / 24;
    EXPECT_NEAR_VEC(turned.corner(frame), (Vec3{float(std::cos(a)), 0, float(-std::sin(a))}), kRounding);
  }
}

TEST(SceneAnimation, RotationTakesTheShorterArc) {
  const Animated turned("rotation", {0, 1}, {0, 0, 0, 1, 0, -kHalf, 0, -kHalf});  // the same end, other sign
  EXPECT_NEAR_VEC(turned.corner(12), (Vec3{kHalf, 0, -kHalf}), kRounding);
}

TEST(SceneAnimation, CubicSplineIsTheHermiteCurve) {
  // in, value, out per key; dt = 2 s. At half: v0/2 + v1/2 + dt (out0 - in1) / 8 = 0 + 0.5 + 2 (4 - 2) / 8 =
  // 1; at a quarter: v1 (3/16 - 2/64) + dt (out0 (1/64 - 2/16 + 1/4) + in1 (1/64 - 1/16)) = 0.15625 + 1.125 -
  // 0.1875.
  const Animated moved("translation", {0, 2}, {9, 0, 0, 0, 0, 0, 4, 0, 0, 2, 0, 0, 1, 0, 0, 9, 0, 0}, "CUBICSPLINE");
  EXPECT_NEAR(moved.corner(24).x, 1 + 1.0, kRounding);
  EXPECT_NEAR(moved.corner(12).x, 1 + 1.09375, kRounding);
}

TEST(SceneAnimation, CubicSplineRotationsAreNormalised) {
  const Animated turned("rotation", {0, 1},
                        {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, kHalf, 0, kHalf, 0, 0, 0, 0},
                        "CUBICSPLINE");
  EXPECT_NEAR(length(turned.corner(6)), 1, kRounding);
  EXPECT_NEAR_VEC(turned.corner(12), (Vec3{kHalf, 0, -kHalf}), kRounding);  // halfway by symmetry
}

TEST(SceneAnimation, ChildrenFollowTheirParents) {
  GltfMaker maker;
  const int child = maker.add_node({{"mesh", maker.add_triangle()}, {"translation", {1, 0, 0}}}, false);
  const int parent = maker.add_node({{"children", {child}}, {"scale", {2, 2, 2}}, {"translation", {0, 0, 5}}});
  maker.animate(parent, "rotation", {0, 1}, {0, 0, 0, 1, 0, kHalf, 0, kHalf});
  const Scene scene = maker.load();
  const SceneFrame at = scene_at_frame(scene, segment_of(scene, 24, {}), 24, {});
  // corner (1,0,0) -> (2,0,0) in the parent -> scaled (4,0,0) -> turned (0,0,-4) -> moved (0,0,1)
  EXPECT_NEAR_VEC(at.surfaces[0].positions[1], (Vec3{0, 0, 1}), 2 * kRounding);
}

TEST(SceneAnimation, MatricesAreColumnMajor) {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
  const Scene scene = maker.load();
  const SceneFrame at = scene_at_frame(scene, segment_of(scene, 0, {}), 0, {});
  EXPECT_EQ(at.surfaces[0].positions[1], (Vec3{5, 7, 7}));
}

TEST(SceneAnimation, AKeyAtAFrameIsMetExactlyThoughItsTimeIsRounded) {
  // 7/24 s is no float32: the key's time in the file differs slightly from the frame's time, and a fast movement
  // would show this.
  AnimationTrack track;
  for (int k = 0; k <= 48; ++k) {
    track.times_s.push_back(double(float(k / 24.0)));
    track.values.insert(track.values.end(), {double(k % 2) * 1000, 0, 0});
  }
  for (int k = 0; k <= 48; ++k) EXPECT_EQ(evaluate(track, k / 24.0)[0], double(k % 2) * 1000) << k;
}

TEST(SceneAnimation, BetweenEqualKeysTheValueIsExact) {
  AnimationTrack track;
  track.path = AnimationTrack::Path::rotation;
  const double third = std::sqrt(1 / 3.0);
  track.times_s = {0, 1};
  track.components = 4;
  track.values = {third, third, 0, third, third, third, 0, third};
  for (const double t : {0.1, 0.3, 0.7}) EXPECT_EQ(evaluate(track, t), (std::array{third, third, 0.0, third}));
  track.path = AnimationTrack::Path::translation;
  track.interpolation = AnimationTrack::Interpolation::cubic_spline;
  track.components = 3;
  track.values = {0, 0, 0, 0.1, 0.2, 0.3, 0, 0, 0, 0, 0, 0, 0.1, 0.2, 0.3, 0, 0, 0};
  for (const double t : {0.1, 0.3, 0.7}) EXPECT_EQ(evaluate(track, t), (std::array{0.1, 0.2, 0.3, 0.0}));
}

TEST(SceneAnimation, AllAnimationsPlayTogether) {
  GltfMaker maker;
  for (int i = 0; i < 2; ++i) {
    maker.add_node({{"mesh", maker.add_triangle()}});
    GltfMaker one = maker;
    one.json.erase("animations");
    one.animate(i, "translation", {0, 1}, {0, 0, 0, float(i + 1), 0, 0});
    maker.bytes = one.bytes;
    for (const char* key : {"bufferViews", "accessors"}) maker.json[key] = one.json[key];
    maker.json["animations"].push_back(one.json["animations"][0]);
  }
  const Scene scene = maker.load();
  const std::vector<Affine> world = world_from_node(scene, 12, {});
  EXPECT_EQ(world[0].translation.x, 0.5);
  EXPECT_EQ(world[1].translation.x, 1.0);
  EXPECT_EQ(scene.duration_s, 1);
}

/// Two animations of one node: "Left" for one second, and one without a name for two.
GltfMaker two_animations() {
  GltfMaker maker;
  maker.add_node({{"mesh", maker.add_triangle()}});
  maker.animate(0, "translation", {0, 1}, {0, 0, 0, -1, 0, 0});
  Json left = maker.json["animations"][0];
  maker.json.erase("animations");
  maker.animate(0, "translation", {0, 2}, {0, 0, 0, 5, 0, 0});
  left["name"] = "Left";
  maker.json["animations"] = {left, maker.json["animations"][0]};
  return maker;
}

TEST(SceneAnimation, OneAnimationCanBeChosenByName) {
  const std::string path = write_file("two.gltf", two_animations().text());
  const Scene left = load_gltf(path, {.animation = "Left"}), other = load_gltf(path, {.animation = "animation 1"});
  EXPECT_EQ(world_from_node(left, 24, {})[0].translation.x, -1);
  EXPECT_EQ(left.duration_s, 1);
  EXPECT_EQ(world_from_node(other, 24, {})[0].translation.x, 2.5);
  EXPECT_EQ(other.duration_s, 2);
  EXPECT_TRUE(left.warnings.empty());
  // With all animations together two of them animate one node: the first in the file is used, and a warning says so.
  const Scene both = load_gltf(path);
  EXPECT_EQ(world_from_node(both, 24, {})[0].translation.x, -1);
  EXPECT_TRUE(has_warning(both, "--animation NAME chooses one"));
}

TEST(SceneAnimation, AnAnimationThatDoesNotExistListsThoseThatDo) {
  const std::string path = write_file("two.gltf", two_animations().text());
  EXPECT_CONTAINS(load_error(path, {.animation = "Right"}),
                  "animations: none is named \"Right\"; there is Left, animation 1");
  GltfMaker still;
  still.add_node({{"mesh", still.add_triangle()}});
  EXPECT_CONTAINS(load_error(write_file("still.gltf", still.text()), {.animation = "Right"}), "there is none at all");
}

TEST(SceneAnimation, TheMovingBoxOfTheCornellScene) {
  if (shared_scenes().empty()) GTEST_SKIP() << "../shared/scenes is not there";
  const Scene scene = load_gltf((shared_scenes() / "made/S2_cornell_moving.glb").string());
  const Segment segment = segment_of(scene, 10, {});
  ASSERT_EQ(scene_at_frame(scene, segment, 10, {}).static_count, 8u);
  // Worked out from the file by an independent script: key 10 of the box's tracks, applied to its first
  // vertex.
  const SceneFrame at = scene_at_frame(scene, segment, 10, {});
  EXPECT_NEAR_VEC(at.surfaces[8].positions[0], (Vec3{-0.884213512f, 0.0f, 0.691094455f}), kRounding);
}

}  // namespace
}  // namespace tempolux
