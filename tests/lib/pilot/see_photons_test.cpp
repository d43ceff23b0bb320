// Light that photons show on a wall above a floor with or without a mirror, and the light that paths find there.
#include "lib/pilot/see_photons.h"

#include <gtest/gtest.h>

#include <array>

#include "lib/pilot/choose_light.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/places_seen.h"
#include "tests/support/frames.h"
#include "tests/support/materials.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

Material mirror(float roughness) {
  Material m = test::matte(Rgb(1.0f));
  m.metallic = 1;
  m.roughness = roughness;
  return m;
}

struct Pilots {
  SeenPhotons photons, indirect;
  RoughFrame rough;
  std::vector<Way> ways;
};
/// A wall 4 m wide at z = 0.
void add_wall(test::HandMadeScene& scene) {
  scene.add_quad({0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, test::matte(Rgb(0.5f)));
}
/// An orthographic camera that sees 3.2 x 1.8 m of the wall.
CameraView view_of_wall() {
  PlacedCamera camera;
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 0.9f;
  camera.scene_from_camera.translation = {2, 1.5f, 7};
  return CameraView(camera, {}, 64, 36);
}

/// Pilots of the wall in this scene.
Pilots pilots_of(test::HandMadeScene& scene) {
  add_wall(scene);
  const SceneFrame frame = scene.frame();
  const EmissionTable table = build_emission_table(std::span(&frame, 1));
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  const CameraView view = view_of_wall();
  const RoughFrame rough =
      rough_frame({tracer, lights}, lights, view,
                  {.kinds = "caustic,indirect", .pixel_error = 0.016, .photons = 100'000, .seen = {}, .seed = 0});
  const formats::PhotonBlock photons = pilot_photons(tracer, lights, "caustic,indirect", 32768, 0);
  const SeenLight seen = see_photons({tracer, lights}, view, photons);
  return {seen.caustic, seen.indirect, rough, ways_to_light(rough, {320 * 180, 100'000}, true)};
}

/// The same with a floor in front of the wall.
Pilots pilots_of(test::HandMadeScene& scene, const Material& floor) {
  scene.add_quad({-4, 0, 8}, {8, 0, 8}, {8, 0, 0}, {-4, 0, 0}, floor);
  return pilots_of(scene);
}

/// A point lamp of I = 1 W/sr, 2 m before the wall at the camera's height, over a mirror: its mirror image lights the
/// wall once more from 2 m below the floor. Photons estimate the mean of rho / pi I cos / d^2 over the picture, cos = 2
/// / d. Of 32768 paths one in 70 arrives in the picture, a noise of 5 % if they were independent; stratified ones have
/// less. No path finds this light, so all of it is missed.
TEST(SeePhotons, APointLampInAMirrorNeedsAMap) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  const auto [photons, indirect, rough, ways] = pilots_of(scene, mirror(0));
  double expected = 0;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 36; ++j) {
      const double x = 0.4 + 3.2 * (i + 0.5) / 64 - 2, y = 0.6 + 1.8 * (j + 0.5) / 36 + 2, d2 = x * x + y * y + 4;
      expected += 0.5 / M_PI * 2 / (d2 * std::sqrt(d2)) / (64 * 36);
    }
  EXPECT_NEAR(photons.mean / expected, 1, 0.1);
  EXPECT_NEAR(photons.mean_error / expected, 0.05, 0.02);
  EXPECT_GT(rough.path.missed_caustic.square, 0.5 * photons.square / (rough.radiance * rough.radiance))
      << "no path finds it";
  EXPECT_TRUE(ways.front().map);
  EXPECT_EQ(indirect.mean, 0) << "a single wall lights nothing";
  EXPECT_EQ(ways.front().method, IndirectMethod::paths);
}

/// The mirror is 6 cm wide and lies where it sends the lamp's light to the middle of the picture: it covers .0036 x .87
/// / 5.3 = .0006 sr, one or two of 32768 photons. Their noise is most of their mean, but paths find none of this light,
/// so even a single photon proves that paths lack some.
TEST(SeePhotons, AFewPhotonsProveLightThatPathsDoNotFind) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  scene.add_quad({1.97f, 0, 0.887f}, {2.03f, 0, 0.887f}, {2.03f, 0, 0.827f}, {1.97f, 0, 0.827f}, mirror(0));
  const auto [photons, indirect, rough, ways] = pilots_of(scene);
  EXPECT_GT(photons.mean, 0);
  EXPECT_LT(photons.mean, 3 * photons.mean_error);
  EXPECT_GT(rough.path.missed_caustic.square, 0.2 * photons.square / (rough.radiance * rough.radiance));
}

/// A point lamp over a floor of metal of roughness .25 beside the wall. The light that samples above a value hold is
/// that of a million camera paths, whose own noise is below 3 %; photons of 32768 light paths have 5 %.
TEST(SeePhotons, ShowLoneSamplesOfPaths) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  add_wall(scene);
  scene.add_quad({-4, 0, 8}, {8, 0, 8}, {8, 0, 0}, {-4, 0, 0}, mirror(0.25f));
  const test::Lit lit(scene.frame());
  const Tracer& tracer = lit.tracer;
  const Lights& lights = lit.lights;
  const CameraView view = view_of_wall();
  const formats::PhotonBlock photons = pilot_photons(tracer, lights, "caustic", kPilotPaths, 0, true);
  constexpr std::uint32_t kSamples = 512;
  const std::array<float, 3> cuts{1e-6f, 0.3f, 1};
  std::array<double, 3> paths{};
  RayCounts rays;
  for (std::uint32_t pixel = 0; pixel < 64 * 36; ++pixel)
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const float found = trace_eye_path({tracer, lights}, view.middle(int(pixel % 64), int(pixel / 64)),
                                         PixelRandom(1, pixel, i), nullptr, rays)[Layer::caustic]
                              .g;
      for (std::size_t c = 0; c < cuts.size(); ++c)
        if (found > cuts[c]) paths[c] += double(found) / (64 * 36 * kSamples);
    }
  for (std::size_t c = 0; c < cuts.size(); ++c) {
    double sum = 0;
    for (const double part : lone_light({tracer, lights}, view, photons, double(cuts[c]))) sum += part / kPilotParts;
    EXPECT_NEAR(sum / paths[c], 1, 0.12) << cuts[c];
  }
  EXPECT_LT(paths[2], 0.7 * paths[0]);
}

/// A shining ceiling over a glossy floor: paths from the wall meet the ceiling after the floor. They find the same
/// light as photons.
TEST(SeePhotons, AWideLampInGlossIsNotMissed) {
  test::HandMadeScene scene;
  scene.add_quad({-4, 6, 0}, {8, 6, 0}, {8, 6, 8}, {-4, 6, 8}, test::matte(Rgb(0.0f), Rgb(1.0f)));
  const auto [photons, indirect, rough, ways] = pilots_of(scene, mirror(0.6f));
  EXPECT_GT(photons.mean, 0);
  EXPECT_EQ(rough.path.missed_caustic.square, 0) << "both find the same light";
}

/// A sun without size, E = 1 W/m^2, shines at right angles through a slab of smooth glass, through which the camera
/// sees the wall. A face reflects R = (n - 1)^2 / (n + 1)^2 = .04. With all reflections between its faces, the slab
/// transmits T = (1 - R) / (1 + R) [Stokes 1862], once on the way to the wall and once to the camera: the radiance is
/// rho / pi E T^2. The wall's border is farther from the picture than a footprint is wide. 4096 camera rays of which
/// T pass err by (T (1 - T) / 4096)^1/2 = .4 %; the photons' own error is measured.
TEST(SeePhotons, TheSunIsSeenThroughASlabOfGlass) {
  test::HandMadeScene scene;
  scene.add_open_box({-1, -1, 1}, {5, 5, 1.1f}, test::glass(0));
  scene.add_sun({0, 0, -1}, Rgb(1.0f));
  const auto [photons, indirect, rough, ways] = pilots_of(scene);
  const double transmitted = 0.96 / 1.04, expected = 0.5 / M_PI * transmitted * transmitted;
  EXPECT_LT(photons.mean_error / expected, 0.05);
  EXPECT_NEAR(photons.mean, expected, 4 * (photons.mean_error + 0.004 * expected));
  EXPECT_EQ(rough.radiance, 0) << "no path finds any light";
  const double level = photons.mean + indirect.mean;
  EXPECT_GT(rough.path.missed_caustic.square, 0.5 * photons.square / (level * level));
  EXPECT_TRUE(ways.front().map);
}

TEST(SeePhotons, WithoutMirrorsThereIsNoneToFind) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  const auto [photons, indirect, rough, ways] = pilots_of(scene, test::matte(Rgb(0.5f)));
  EXPECT_EQ(photons.mean, 0);
  EXPECT_EQ(rough.path.missed_caustic.square, 0);
  EXPECT_FALSE(ways.front().map);
}

}  // namespace
}  // namespace tempolux
