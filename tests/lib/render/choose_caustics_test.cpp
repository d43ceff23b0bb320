// Is caustic light worth a photon map where paths find all other light? Two pilots of a wall over a floor that mirrors or does not.
#include "lib/render/choose_caustics.h"

#include <gtest/gtest.h>

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
  IndirectPilot paths;
  SeenPhotons photons, indirect;
};
/// A wall 4 m wide, z = 0, seen whole by an orthographic camera of 3.2 x 1.8 m, and a floor before it.
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
  return {pilot_indirect({tracer, lights}, view, 0.016, 0), see_photons({tracer, lights}, view, "caustic", 0), see_photons({tracer, lights}, view, "indirect", 0)};
}

/// A point lamp 2 m before the wall and as high, I = 1 W/sr, over a mirror: it lights the wall once more from 2 m below the floor. The mean
/// of rho / pi I cos / d^2 over the picture, cos = 2 / d, is what photons tell: of 32768 paths one in 70 arrives in the picture, which is
/// 5 % of noise if they were independent; evenly spread they are better. No path can find that light, so it is all of their error.
TEST(ChooseCaustics, APointLampInAMirrorNeedsAMap) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  const auto [paths, photons, indirect] = pilots_of(scene, mirror(0));
  double expected = 0;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 36; ++j) {
      const double x = 0.4 + 3.2 * (i + 0.5) / 64 - 2, y = 0.6 + 1.8 * (j + 0.5) / 36 + 2, d2 = x * x + y * y + 4;
      expected += 0.5 / M_PI * 2 / (d2 * std::sqrt(d2)) / (64 * 36);
    }
  EXPECT_EQ(paths.caustic, 0);
  EXPECT_NEAR(photons.mean / expected, 1, 0.1);
  EXPECT_NEAR(photons.mean_error / expected, 0.05, 0.02);
  EXPECT_TRUE(choose_caustics(paths, photons).map);
  EXPECT_EQ(indirect.mean, 0) << "a single wall lights nothing";
  EXPECT_EQ(choose_beside_caustics(paths, photons, indirect).method, IndirectMethod::paths);
}

/// A ceiling that shines, over gloss: paths that leave the wall for the floor meet it, and its light hardly differs from path to path.
TEST(ChooseCaustics, AWideLampInGlossNeedsNone) {
  test::HandMadeScene scene;
  scene.add_quad({-4, 6, 0}, {8, 6, 0}, {8, 6, 8}, {-4, 6, 8}, test::matte(Rgb(0.0f), Rgb(1.0f)));
  const auto [paths, photons, indirect] = pilots_of(scene, mirror(0.6f));
  EXPECT_NEAR(photons.mean / paths.caustic, 1, 0.1) << "both find the same light";
  EXPECT_FALSE(choose_caustics(paths, photons).map);
}

TEST(ChooseCaustics, WithoutMirrorsThereIsNoneToFind) {
  test::HandMadeScene scene;
  scene.add_point_light({2, 2, 2}, Rgb(1.0f));
  const auto [paths, photons, indirect] = pilots_of(scene, test::matte(Rgb(0.5f)));
  EXPECT_EQ(paths.caustic, 0);
  EXPECT_EQ(photons.mean, 0);
  EXPECT_FALSE(choose_caustics(paths, photons).map);
}

/// Radiance c that none of n paths found has a variance of n c^2 or more, less what photons may err by. Of 16 samples a pixel that leaves
/// n / 16 c^2; a map leaves 1/25 of the mean square and costs 2.5 times as much. (Three standard errors are taken off.)
TEST(ChooseCaustics, FollowsFromBothErrors) {
  IndirectPilot paths;
  paths.paths = 1600;
  paths.samples = 16;
  paths.rest_noise = 1;
  EXPECT_TRUE(choose_caustics(paths, {0.125, 0, 0}).map);        // 100 / 64: 2.56 times the error
  EXPECT_FALSE(choose_caustics(paths, {0.12, 0, 0}).map);        // 2.44
  EXPECT_FALSE(choose_caustics(paths, {0.125, 0.01, 0}).map) << "photons may err";
  EXPECT_FALSE(choose_caustics(paths, {0.125, 0, 1.0}).map) << "so does the map";
  paths.caustic = 0.125;
  EXPECT_FALSE(choose_caustics(paths, {0.125, 0, 0}).map) << "paths found it";
  paths.caustic_variance = 32;
  EXPECT_TRUE(choose_caustics(paths, {0.125, 0, 0}).map) << "but some of them all of it";
}

/// Light of radiance 1 that mirrors bring, 16 samples a pixel and 1600 paths that met nothing of the .2 that it sends on: 1600 x .04 / 16 = 4 is what they would
/// err by, a map 1/25. Not if that is less than 5 % of all, if photons know it badly, if other light is as noisy, or if paths found it.
TEST(ChooseCaustics, GathersWhatPathsDoNotFindAfterABounce) {
  IndirectPilot paths;
  paths.paths = 1600;
  paths.samples = 16;
  paths.open_share = 0.5;
  const SeenPhotons caustic{1, 0, 1}, indirect{0.2, 0, 0};
  const auto method = [&](const SeenPhotons& seen) { return choose_beside_caustics(paths, caustic, seen).method; };
  EXPECT_EQ(method(indirect), IndirectMethod::gather);
  EXPECT_EQ(method({0.05, 0, 0}), IndirectMethod::paths) << "1 / 21 of all";
  EXPECT_EQ(method({0.2, 0.05, 0}), IndirectMethod::paths) << "perhaps .05";
  paths.rest_noise = 0.8;
  EXPECT_EQ(method(indirect), IndirectMethod::paths) << "4 / .84";
  paths.rest_noise = 0.7;
  EXPECT_EQ(method(indirect), IndirectMethod::gather) << "4 / .74";
  paths.scattered = 0.2;
  paths.indirect_share = 1;
  EXPECT_EQ(method(indirect), IndirectMethod::paths) << "found";
  paths.open_share = 0.2;
  EXPECT_EQ(method(indirect), IndirectMethod::records) << "a room";
}

}  // namespace
}  // namespace tempolux
