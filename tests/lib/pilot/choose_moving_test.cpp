// Decisions to reuse static light: known shares, and the choice that follows from them.
#include "lib/pilot/choose_moving.h"

#include <gtest/gtest.h>

#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// A closed room of 4 m with a lamp under its ceiling, and a small box that moves; seen from a wall.
struct Room {
  test::HandMadeScene scene;
  SceneFrame frame;
  EmissionTable table;

  Room(Vec3 at, float size, bool lamp_moves) {
    scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
    scene.add_quad({1.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 2.5f}, {1.5f, 3.9f, 2.5f},
                   test::matte(Rgb(0.0f), Rgb(5.0f)), lamp_moves);
    scene.add_quad(at, at + Vec3{0, 0, size}, at + Vec3{size, 0, size}, at + Vec3{size, 0, 0}, test::matte(Rgb(0.5f)),
                   true);
    frame = scene.frame();
    table = build_emission_table(std::span(&frame, 1));
  }
  MovingPilot pilot() const {
    PlacedCamera camera;  // orthographic, 4.8 x 2.7 m, looking along -z
    camera.camera.kind = Camera::Kind::orthographic;
    camera.camera.ymag_m = 1.35f;
    camera.scene_from_camera.translation = {2, 1.4, 3.9};
    const Tracer tracer(frame);
    const Lights lights(frame, table);
    return pilot_moving({tracer, lights}, table, CameraView(camera, {}, 64, 36), 0);
  }
};

TEST(MovingPilot, OutOfTheWayOfAllLightNothingIsTouched) {
  const MovingPilot pilot = Room({10, 1, 10}, 0.2f, false).pilot();
  EXPECT_EQ(pilot.touched_share, 0);
  EXPECT_EQ(pilot.gathered_share, 0);
}

TEST(MovingPilot, UnderTheLampItMattersMoreTheLargerItIs) {
  const MovingPilot small = Room({1.9f, 1, 1.9f}, 0.2f, false).pilot(), large = Room({1, 3, 1}, 2, false).pilot();
  EXPECT_GT(small.touched_share, 0);
  EXPECT_LT(small.touched_share, 0.05);
  EXPECT_LT(small.gathered_share, 0.5);
  EXPECT_GT(large.touched_share,
            // The lamp shines to both sides, and an area of 2 x 2 m at .9 m below receives .60 of one side, by the form
            // factor.
            0.28);
  EXPECT_GT(large.gathered_share, 0.9);
}

TEST(MovingPilot, AMovingLampTouchesAll) {
  const MovingPilot pilot = Room({10, 1, 10}, 0.2f, true).pilot();
  EXPECT_EQ(pilot.touched_share, 1);
}

TEST(ChooseMoving, WhateverIsCheaper) {
  const double once = 1 / 24.0;
  EXPECT_EQ(choose_moving({0.03, 0.2}, 24, once).method, MovingMethod::records);
  EXPECT_EQ(choose_moving({0.07, 0.99}, 24, once).method, MovingMethod::light);  // records: 1/24 + .1 + .99
  EXPECT_EQ(choose_moving({0.07, 0.2}, 24, once).method, MovingMethod::records);
  EXPECT_EQ(choose_moving({0.07, 0.2}, 24, 0.71).method,
            MovingMethod::light);  // each camera sees other places: .71 + .1 + .2
  EXPECT_EQ(choose_moving({0.3, 0.99}, 24, once).method, MovingMethod::anew);
  EXPECT_EQ(choose_moving({1, 0}, 24, once).method, MovingMethod::anew);
  // The static scene is computed once: for one state its light would be computed twice.
  EXPECT_EQ(choose_moving({0.03, 0.2}, 1, 1).method, MovingMethod::anew);
}

/// f = sqrt(.8 x .3 / (s .2)): 5.4 for a 24th, 1.36 for s = .65. Only records that follow from static records have
/// them.
TEST(ChooseMoving, StaticRecordsThatManyShareGetMoreRays) {
  EXPECT_EQ(choose_moving({0.03, 0.2}, 24, 1 / 24.0).static_ray_factor, 2);
  EXPECT_EQ(choose_moving({0.03, 0.2}, 24, 0.65).method, MovingMethod::records);
  EXPECT_EQ(choose_moving({0.03, 0.2}, 24, 0.65).static_ray_factor, 1);
  EXPECT_EQ(choose_moving({0.03, 0}, 24, 1 / 24.0).static_ray_factor, 2);
  EXPECT_EQ(choose_moving({0.07, 0.99}, 24, 1 / 24.0).static_ray_factor, 1);
}

}  // namespace
}  // namespace tempolux
