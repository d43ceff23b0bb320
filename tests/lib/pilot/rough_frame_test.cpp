// Measurements of a rough frame in known scenes.
#include "lib/pilot/rough_frame.h"

#include <gtest/gtest.h>

#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

RoughFrame rough_of(const SceneFrame& frame, int width = 64, std::uint64_t photons = 65536,
                    const std::function<bool(const RoughFrame&)>& enough = {}, int places = kPilotPlaces) {
  const EmissionTable table = build_emission_table(std::span(&frame, 1));
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  PlacedCamera camera;  // orthographic, 3.2 x 1.8 m, looking along -z
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 0.9f;
  camera.scene_from_camera.translation = {2, 2, 3.8};
  return rough_frame({tracer, lights}, lights, CameraView(camera, {}, width, width * 9 / 16),
                     {.kinds = "indirect",
                      .pixel_error = 0.016,
                      .photons = photons,
                      .seen = {},
                      .seed = 0,
                      .places = places,
                      .enough = enough});
}

SceneFrame room(test::HandMadeScene& scene) {
  scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
  scene.add_quad({1.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 2.5f}, {1.5f, 3.9f, 2.5f},
                 test::matte(Rgb(0.0f), Rgb(5.0f)));
  return scene.frame();
}

/// A closed room without gloss: every camera ray meets a wall, and no ray leaves. A path takes at least two rays. A
/// path that ends at a point takes the camera ray, the ray onward and their light samples, and no more if points
/// represent the hits: fewer than a path. The variance of all light is that of direct plus that of indirect light,
/// which are drawn independently: at least the former.
TEST(RoughFrame, OfAClosedRoom) {
  test::HandMadeScene scene;
  const RoughFrame rough = rough_of(room(scene));
  EXPECT_GT(rough.places, 2000);
  EXPECT_GT(rough.path.work, 2 * Work::kRay);
  EXPECT_LT(rough.gather.work, rough.path.work);
  EXPECT_LT(rough.record_sample - 1, rough.path.work) << "no ray after the first onward";
  EXPECT_GT(rough.path.all, 1.1 * rough.path.other);
  EXPECT_GT(rough.wanted, 0);
  EXPECT_GE(rough.samples, 4);
  for (const CausticPart& part : rough.caustic) EXPECT_EQ(part.square, 0) << "nothing is caustic";
  EXPECT_EQ(rough.path.missed_caustic.square, 0);
  EXPECT_LT(rough.path.missed_indirect.lone, 0.016) << "less than the wish's error";
  EXPECT_EQ(rough.path.missed_indirect.uncertain, 0);
}

/// A lamp of 30 cm above a black board shines at the ceiling from 3 cm. Nearly all light of the room comes from the
/// spot there. A path from a wall meets the spot, of .1 m^2, with a chance of cos cos A / (pi d^2) = .5 .1 / (8 pi) =
/// 1/500. It brings 500 times the picture's mean, of which a white pixel of n samples shows at most n (.1 / .18) means:
/// less than .07 for n = 60. The 32768 samples meet the spot 66 +- 8 times and photons show the whole picture, so the
/// share that is lost is .93 +- .12; three deviations below is .57.
TEST(RoughFrame, OneSampleInHundredsMeetsTheLight) {
  test::HandMadeScene scene;
  scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
  scene.add_quad({1.85f, 3.97f, 1.85f}, {1.85f, 3.97f, 2.15f}, {2.15f, 3.97f, 2.15f}, {2.15f, 3.97f, 1.85f},
                 test::matte(Rgb(0.0f), Rgb(5000.0f)));
  scene.add_quad({1.8f, 3.965f, 1.8f}, {2.2f, 3.965f, 1.8f}, {2.2f, 3.965f, 2.2f}, {1.8f, 3.965f, 2.2f},
                 test::matte(Rgb(0.0f)));  // lamps shine to both sides
  const RoughFrame rough = rough_of(scene.frame(), 64, 65536, {}, 8192);
  EXPECT_LT(rough.samples, 60);
  EXPECT_GT(rough.path.missed_indirect.lone, 0.5);
}

/// The same room, in which an unlit quad of 20 cm stands before the camera. The quad lights nothing, and is 10^5 times
/// as bright as the room. The quad covers .7 % of the picture, so it would be 700 times the light of the room if it
/// counted in full; as white it counts .7 % / .18 of the median. So the lost light stays the same share within the
/// pixels that the quad hides.
TEST(RoughFrame, ALampInViewDoesNotHideTheRoom) {
  double lost[2] = {};
  for (const bool in_view : {false, true}) {
    test::HandMadeScene scene;
    scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
    scene.add_quad({1.85f, 3.97f, 1.85f}, {1.85f, 3.97f, 2.15f}, {2.15f, 3.97f, 2.15f}, {2.15f, 3.97f, 1.85f},
                   test::matte(Rgb(0.0f), Rgb(5000.0f)));
    scene.add_quad({1.8f, 3.965f, 1.8f}, {2.2f, 3.965f, 1.8f}, {2.2f, 3.965f, 2.2f}, {1.8f, 3.965f, 2.2f},
                   test::matte(Rgb(0.0f)));
    if (in_view) {
      Material bright = test::matte(Rgb(1e6f));
      bright.unlit = true;
      scene.add_quad({2.5f, 2.5f, 3}, {2.7f, 2.5f, 3}, {2.7f, 2.7f, 3}, {2.5f, 2.7f, 3}, bright);
    }
    lost[in_view] = rough_of(scene.frame()).path.missed_indirect.lone;
  }
  EXPECT_NEAR(lost[1], lost[0], 0.1 * lost[0]);
}

/// A bulb d before the wall in view. Half of its light meets the wall in a spot of about d, and half the other walls.
/// Walls reflect half, so a third of the light that returns to the wall in view comes from the spot. Paths meet the
/// spot with a chance of pi d^2 / (8 pi): with d = 2 mm hardly. In the spot itself, of a few samples, radiance is
/// I / (2 pi d^2), a 10^5 times that of the wall beside it, so it would be nearly all of the picture's mean.
TEST(RoughFrame, ASpotOfDirectLightDoesNotHideTheRoom) {
  test::HandMadeScene scene;
  scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
  scene.add_point_light({1.3f, 2.4f, 0.002f}, Rgb(1.0f));
  const RoughFrame rough = rough_of(scene.frame());
  EXPECT_NEAR(std::sqrt(rough.path.missed_indirect.square), 1.0 / 3, 0.1);
}

/// A dark room with a hole of 10 cm in its right wall, behind which a lamp on the wall lights a board. A path meets the
/// hole with a chance of about A / (8 pi) = 1 in 2500, so a few of 8192 samples find all light there is. With a hole
/// of 1 m hundreds do.
TEST(RoughFrame, AFewSamplesThatFindAllLightAreNoMeasurement) {
  for (const float half : {0.05f, 0.5f}) {
    test::HandMadeScene scene;
    const Material wall = test::matte(Rgb(0.5f));
    const float a = 2 - half, b = 2 + half;
    const auto across = [&](float x, float y0, float y1, float z0, float z1, const Material& material) {
      scene.add_quad({x, y0, z0}, {x, y0, z1}, {x, y1, z1}, {x, y1, z0}, material);
    };
    scene.add_quad({0, 0, 0}, {4, 0, 0}, {4, 0, 4}, {0, 0, 4}, wall);
    scene.add_quad({0, 4, 0}, {4, 4, 0}, {4, 4, 4}, {0, 4, 4}, wall);
    scene.add_quad({0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, wall);
    scene.add_quad({0, 0, 4}, {4, 0, 4}, {4, 4, 4}, {0, 4, 4}, wall);
    across(0, 0, 4, 0, 4, wall);
    across(4, 0, a, 0, 4, wall);
    across(4, b, 4, 0, 4, wall);
    across(4, a, b, 0, a, wall);
    across(4, a, b, b, 4, wall);
    across(5, 0, 4, 0, 4, wall);
    across(4.05f, 3, 3.5f, 1.5f, 2.5f, test::matte(Rgb(0.0f), Rgb(50.0f)));
    const float unsure = float(rough_of(scene.frame()).path.missed_indirect.uncertain);
    EXPECT_EQ(unsure > 0.9f, half < 0.1f) << half << " m: " << unsure;
  }
}

/// The measurement ends when the answer is known. Paths are still measured, and the reported work and error of the
/// others are lower bounds of what a full measurement finds.
TEST(RoughFrame, EndsWhenTheAnswerIsKnown) {
  test::HandMadeScene scene;
  const SceneFrame frame = room(scene);
  const RoughFrame whole = rough_of(frame);
  const RoughFrame paths = rough_of(frame, 64, 65536, [](const RoughFrame&) { return true; });
  const RoughFrame gathered = rough_of(frame, 64, 65536, [](const RoughFrame& rough) { return rough.gathered; });
  EXPECT_TRUE(whole.gathered && whole.recorded);
  EXPECT_FALSE(paths.gathered || paths.recorded);
  EXPECT_TRUE(gathered.gathered && !gathered.recorded);
  EXPECT_EQ(paths.path.all, whole.path.all);
  EXPECT_EQ(gathered.gather.all, whole.gather.all);
  EXPECT_GT(whole.records, 0);
  EXPECT_EQ(gathered.records, 0);
  EXPECT_LE(paths.gather.work, whole.gather.work);
  EXPECT_LE(paths.record_sample, whole.record_sample);
  EXPECT_LE(paths.gather.all, whole.gather.all);
}

/// A wall divides the room, and one half is dark. A frame's points are 6 times as dense as a rough frame's, so nearly
/// all rays end at their first hit. The work of a sample is at most 2 for the camera ray, 2 for the onward ray, 1 for
/// the light sample and 1 for the point. One ray in 25 finds no point in a fold of the room and costs 5 more: 6.20 in
/// all. If points were compared with neighbours across the wall, rays in the lit half would continue next to it:
/// 6.52.
TEST(RoughFrame, RaysEndAtPointsAsInAFrame) {
  test::HandMadeScene scene;
  scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
  scene.add_quad({2, 0, 0}, {2, 4, 0}, {2, 4, 4}, {2, 0, 4}, test::matte(Rgb(0.5f)));
  scene.add_quad({0.5f, 3.9f, 1.5f}, {1.5f, 3.9f, 1.5f}, {1.5f, 3.9f, 2.5f}, {0.5f, 3.9f, 2.5f},
                 test::matte(Rgb(0.0f), Rgb(5.0f)));
  EXPECT_LT(rough_of(scene.frame(), 64, std::uint64_t(1) << 40).gather.work, 6.35);
}

/// The number of records does not grow with the number of pixels as long as pixels do not limit radii. Here radii are
/// 20 cm and more, because all surfaces are 1 m away and more. With 64 pixels a pixel is 5 cm wide and a record is
/// valid over 4 of them; with 640 pixels over 40. The places differ between the two: a fifth.
TEST(RoughFrame, CountsRecordsByWhatTheySee) {
  test::HandMadeScene scene;
  const SceneFrame frame = room(scene);
  EXPECT_NEAR(rough_of(frame, 640).records / rough_of(frame, 320).records, 1, 0.2);
}

/// The squared error of a record's light: a lamp twice as bright makes it four times as large, and the squared error
/// that a pixel may have, too. So the ratio stays the same up to rounding.
TEST(RoughFrame, DoesNotDependOnTheStrengthOfLight) {
  const auto lit_by = [](float radiance) {
    test::HandMadeScene scene;
    scene.add_room({0, 0, 0}, {4, 4, 4}, test::matte(Rgb(0.5f)));
    scene.add_quad({1.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 2.5f}, {1.5f, 3.9f, 2.5f},
                   test::matte(Rgb(0.0f), Rgb(radiance)));
    return rough_of(scene.frame());
  };
  const RoughFrame weak = lit_by(1), strong = lit_by(1024);
  EXPECT_NEAR(strong.record_error / weak.record_error, 1, 1e-3);
  EXPECT_NEAR(strong.path.all / weak.path.all, 1, 1e-3);
  EXPECT_NEAR(strong.samples / weak.samples, 1, 1e-3);
}

/// A board in empty space, lit by a lamp in front of it: no ray from it meets a surface that could reflect light except
/// the lamp, which is black.
TEST(RoughFrame, OfABoardAloneHasNoIndirectLight) {
  test::HandMadeScene scene;
  scene.add_quad({0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, test::matte(Rgb(0.5f)));
  scene.add_quad({1.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 1.5f}, {2.5f, 3.9f, 2.5f}, {1.5f, 3.9f, 2.5f},
                 test::matte(Rgb(0.0f), Rgb(5.0f)));
  const RoughFrame rough = rough_of(scene.frame());
  EXPECT_EQ(rough.path.all, rough.path.other);
  EXPECT_EQ(rough.record_error, 0);
  EXPECT_EQ(rough.path.missed_indirect.square, 0);
}

}  // namespace
}  // namespace tempolux
