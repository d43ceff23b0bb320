// Light that photons show on a wall above a floor with or without a mirror, and the light that paths find there.
#include "lib/render/see_photons.h"

#include <gtest/gtest.h>

#include "lib/render/choose_light.h"
#include "lib/render/pilot_photons.h"
#include "tests/support/frames.h"
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
/// A wall 4 m wide at z = 0, seen whole by an orthographic camera of 3.2 x 1.8 m, and a floor in front of it.
Pilots pilots_of(test::HandMadeScene& scene, const Material& floor) {
  scene.add_quad({0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, test::matte(Rgb(0.5f)));
  scene.add_quad({-4, 0, 8}, {8, 0, 8}, {8, 0, 0}, {-4, 0, 0}, floor);
  const SceneFrame frame = scene.frame();
  const EmissionTable table = build_emission_table(std::span(&frame, 1));
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  PlacedCamera camera;
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 0.9f;
  camera.scene_from_camera.translation = {2, 1.5f, 7};
  const CameraView view(camera, {}, 64, 36);
  const RoughFrame rough =
      rough_frame({tracer, lights}, lights, view,
                  {.kinds = "caustic,indirect", .pixel_error = 0.016, .photons = 100'000, .seen = {}, .seed = 0});
  const formats::PhotonBlock photons = pilot_photons(tracer, lights, "caustic,indirect", 32768, 0);
  return {see_photons({tracer, lights}, view, photons, formats::PathKind::caustic),
          see_photons({tracer, lights}, view, photons, formats::PathKind::indirect), rough,
          ways_to_light(rough, {320 * 180, 100'000, 500}, true)};
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
  EXPECT_GT(rough.missed_caustic.square, 0.5 * photons.square / (rough.radiance * rough.radiance))
      << "no path finds it";
  EXPECT_TRUE(ways.front().map);
  EXPECT_EQ(indirect.mean, 0) << "a single wall lights nothing";
  EXPECT_EQ(ways.front().method, IndirectMethod::paths);
}

/// A shining ceiling over a glossy floor: paths from the wall meet the ceiling after the floor. They find the same
/// light as photons.
TEST(SeePhotons, AWideLampInGlossIsNotMissed) {
  test::HandMadeScene scene;
  scene.add_quad({-4, 6, 0}, {8, 6, 0}, {8, 6, 8}, {-4, 6, 8}, test::matte(Rgb(0.0f), Rgb(1.0f)));
  const auto [photons, indirect, rough, ways] = pilots_of(scene, mirror(0.6f));
  EXPECT_GT(photons.mean, 0);
  EXPECT_EQ(rough.missed_caustic.square, 0) << "both find the same light";
}

TEST(SeePhotons, WithoutMirrorsThereIsNoneToFind) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  const auto [photons, indirect, rough, ways] = pilots_of(scene, test::matte(Rgb(0.5f)));
  EXPECT_EQ(photons.mean, 0);
  EXPECT_EQ(rough.missed_caustic.square, 0);
  EXPECT_FALSE(ways.front().map);
}

}  // namespace
}  // namespace tempolux
