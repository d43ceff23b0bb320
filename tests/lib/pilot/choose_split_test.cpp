// Decisions for bright points: a room with a lamp under its ceiling, and a room with a lamp close to a surface.
#include "lib/pilot/choose_split.h"

#include <gtest/gtest.h>

#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// A closed room of 4 m, seen along -z, with a lamp of `size` [m] that faces down at height `above`; its back is dark.
SplitPilot pilot_of(float size, float above) {
  test::HandMadeScene scene;
  scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
  Material lamp = test::matte(Rgb(0.0f), Rgb(5.0f));
  lamp.double_sided = false;
  const float a = 2 - size / 2, b = 2 + size / 2;
  scene.add_quad({a, above, a}, {b, above, a}, {b, above, b}, {a, above, b}, lamp);
  const SceneFrame& frame = scene.frame();
  const test::Lit lit(frame);
  PlacedCamera camera;  // orthographic, 7 x 3.9 m
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 1.95f;
  camera.scene_from_camera.translation = {2, 2, 3.9};
  return pilot_split(lit.scene(), CameraView(camera, {}, 64, 36), 0);
}

/// A lamp under the ceiling lights all of the floor: at most 4 times the mean.
TEST(SplitPilot, NoBrightSpotUnderAWideLamp) {
  const SplitPilot pilot = pilot_of(1, 3.9f);
  EXPECT_LT(pilot.high_share, 0.02);
  EXPECT_LT(pilot.variance_ratio, 1.3);
  EXPECT_FALSE(choose_split(pilot).split);
}

/// A lamp of 0.3 m at 0.1 m above the floor lights about 0.2 of 96 m^2: half of the reflected light comes from there.
TEST(SplitPilot, ALampNearASurface) {
  const SplitPilot pilot = pilot_of(0.3f, 0.1f);
  EXPECT_GT(pilot.high_share, 0.3);
  EXPECT_GT(pilot.variance_ratio, 4);
  EXPECT_TRUE(choose_split(pilot).split);
}

TEST(ChooseSplit, WhereTheVarianceFallsToLessThanHalf) {
  EXPECT_FALSE(choose_split({1, 0}).split);
  EXPECT_FALSE(choose_split({1.9, 0.2}).split);
  EXPECT_TRUE(choose_split({2.1, 0.2}).split);
}

}  // namespace
}  // namespace tempolux
