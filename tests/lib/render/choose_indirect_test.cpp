// How indirect light is found, and by how many rays: a pilot of scenes that are known, and the choice by it.
#include "lib/render/choose_indirect.h"

#include <gtest/gtest.h>

#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

IndirectPilot pilot_of(const SceneFrame& frame) {
  const EmissionTable table = build_emission_table(std::span(&frame, 1));
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  PlacedCamera camera;   // orthographic, 3.2 x 1.8 m, looking along -z
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 0.9f;
  camera.scene_from_camera.translation = {2, 2, 3.8};
  return pilot_indirect({tracer, lights}, CameraView(camera, {}, 64, 36), 0.016, 0);
}

/// A closed room: nothing is open, all light is a lamp's. Of light reflected with .5 at each bounce half or more is indirect but where
/// the lamp is near: a fifth at least.
TEST(IndirectPilot, OfAClosedRoomIsThatOfARoom) {
  test::HandMadeScene scene;
  scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
  scene.add_quad({1.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 2.5f}, {1.5f, 3.9f, 2.5f}, test::matte(Rgb(0.0f), Rgb(5.0f)));
  const SceneFrame frame = scene.frame();
  const IndirectPilot pilot = pilot_of(frame);
  EXPECT_GT(pilot.places, 2000);
  EXPECT_EQ(pilot.open_share, 0);
  EXPECT_EQ(pilot.lamp_share, 1);
  EXPECT_GT(pilot.indirect_share, 0.2);
  EXPECT_LT(pilot.indirect_share, 0.9);
  EXPECT_GT(pilot.indirect_variance, 0);
  EXPECT_GT(pilot.other_error2, 0);
  EXPECT_EQ(choose_indirect(pilot).method, IndirectMethod::records);
}

/// A board before nothing, lit by a lamp before it: no ray from it meets a surface that could send light back but the lamp, which is black.
TEST(IndirectPilot, OfABoardAloneSaysPaths) {
  test::HandMadeScene scene;
  scene.add_quad({0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, test::matte(Rgb(0.5f)));
  scene.add_quad({1.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 2.5f}, {1.5f, 3.9f, 2.5f}, test::matte(Rgb(0.0f), Rgb(5.0f)));
  const SceneFrame frame = scene.frame();
  const IndirectPilot pilot = pilot_of(frame);
  EXPECT_EQ(pilot.indirect_share, 0);
  EXPECT_EQ(pilot.indirect_variance, 0);
  EXPECT_EQ(choose_indirect(pilot).method, IndirectMethod::paths);
}

/// .04 x variance / rays is a tenth of the other error: of 1 and .004 by 100 rays. Within a tenth of `most` and `most`.
TEST(RecordRays, FollowFromBothErrors) {
  IndirectPilot pilot;
  pilot.indirect_variance = 1;
  pilot.other_error2 = 0.004;
  EXPECT_EQ(record_rays(pilot, 500), 100);
  EXPECT_EQ(record_rays(pilot, 64), 64);
  pilot.other_error2 = 1;
  EXPECT_EQ(record_rays(pilot, 500), 50);
  EXPECT_EQ(record_rays(pilot, 5), 1);
  pilot.other_error2 = 0;
  EXPECT_EQ(record_rays(pilot, 500), 500);
}

}  // namespace
}  // namespace tempolux
