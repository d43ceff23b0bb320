// Paths in media: a furnace stays a furnace, layers are separated, the camera may stand inside.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/render/path_tracer.h"
#include "tests/support/materials.h"
#include "tests/support/media.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// Mean of paths along one ray, its standard deviation, and the layers' means.
struct Mean {
  double value = 0, deviation = 0;
  Layers layers;
};

Mean mean_of(const SceneFrame& frame, const Ray& ray, int n) {
  const EmissionTable table = build_emission_table({&frame, 1});
  const Tracer tracer(frame);
  const Lights lights(frame, table);
  const RenderScene scene{tracer, lights};
  Mean mean;
  double sum = 0, square = 0;
  LayersT<double> layers;
  RayCounts counts;
  for (int i = 0; i < n; ++i) {
    const Layers one = trace_eye_path(scene, ray, PixelRandom(5, 9, std::uint32_t(i)), nullptr, counts);
    double total = 0;
    for (std::size_t l = 0; l < kLayerCount; ++l) {
      total += double(one.value[l].g);
      layers.value[l] += Rgbd(one.value[l]) / double(n);
    }
    sum += total;
    square += total * total;
  }
  mean.value = sum / n;
  mean.deviation = std::sqrt(std::max(0.0, square / n - mean.value * mean.value) / n);
  for (std::size_t l = 0; l < kLayerCount; ++l) mean.layers.value[l] = Rgb(layers.value[l]);
  return mean;
}

Material glowing(float rho, float radiance) {
  Material material = test::matte(Rgb(rho));
  material.emission = Rgb(radiance);
  material.double_sided = true;
  return material;
}

/// A closed room with the uniform radiance 1 / (1 - rho): smoke without absorption is invisible in it, from outside and
/// from inside, for any phase function.
TEST(PathMedia, WhiteSmokeIsNotSeenInAFurnace) {
  for (const float g : {0.0f, 0.9f, -0.5f}) {
    test::HandMadeScene scene;
    scene.add_room({-1, -1, -1}, {1, 1, 1}, glowing(0.5f, 1));
    scene.set_media(test::cube_of_medium({}, 1.2, {.sigma_t = 4, .albedo = Rgb(1.0f), .g = g}));
    for (const Ray& ray : {Ray{{-0.9f, 0.05f, 0.02f}, {1, 0, 0}}, Ray{{0.1f, 0.2f, -0.1f}, normalize(Vec3{1, 2, 3})}}) {
      const Mean mean = mean_of(scene.frame(), ray, 4000);
      EXPECT_NEAR(mean.value, 2, 4.5 * mean.deviation + 1e-5) << g;
      EXPECT_LT(mean.deviation, 0.05);
      EXPECT_GT(mean.layers[Layer::volume].g, 0.5f);
    }
  }
}

/// The same with optical depth 1000, where paths have thousands of collisions. Russian roulette that ended them after
/// some hundreds would leave a tenth of the light to paths of large weight that 1200 paths do not find. A path's
/// deviation is 1.4, because walls add a geometric number of ones: .04 of the mean.
TEST(PathMedia, ThickWhiteSmokeLosesNothing) {
  test::HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, glowing(0.5f, 1));
  scene.set_media(test::cube_of_medium({}, 1.2, {.sigma_t = 830, .albedo = Rgb(1.0f), .g = 0.9f}));
  const Mean mean = mean_of(scene.frame(), {{-0.9f, 0.05f, 0.02f}, {1, 0, 0}}, 1200);
  EXPECT_NEAR(mean.value, 2, 0.12);
  EXPECT_LT(mean.deviation, 0.06);
}

/// Beer and Lambert: black smoke of 1.2 m at 0.5 / m before a wall of radiance 3.
TEST(PathMedia, BlackSmokeDims) {
  test::HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, glowing(0, 3));
  scene.set_media(test::cube_of_medium({}, 1.2, {.sigma_t = 0.5f, .albedo = Rgb(0.0f)}));
  const Mean mean = mean_of(scene.frame(), {{-0.9f, 0.05f, 0.02f}, {1, 0, 0}}, 20000);
  EXPECT_NEAR(mean.value, 3 * std::exp(-0.6), 4.5 * mean.deviation);
  EXPECT_EQ(mean.layers[Layer::volume].g, 0);
}

/// A thin medium with single scattering: the radiance is the integral of sigma_s E phase along the ray. A point light
/// of 1 W/sr at 1 m from a path of 0.01 m through the smoke: j = sigma I / d^2 / 4 pi.
TEST(PathMedia, SingleScatteringByClosedForm) {
  test::HandMadeScene scene;
  scene.add_point_light({0, 1, 0}, Rgb(1.0f));
  scene.set_media(test::cube_of_medium({}, 0.02, {.sigma_t = 5, .albedo = Rgb(0.5f)}));
  const Mean mean = mean_of(scene.frame(), {{-0.9f, 0, 0}, {1, 0, 0}}, 40000);
  // Depth 0.1, of which 1 - exp(-0.1) collides; before that, light has lost 5 x 0.01 in the mean on its way in. Light
  // that scatters twice: below 1 %.
  const double exact = -std::expm1(-0.1) * 0.5 / (4 * M_PI) * std::exp(-0.05);
  EXPECT_NEAR(mean.value, exact, 4.5 * mean.deviation + 0.03 * exact);
  EXPECT_NEAR(double(mean.layers[Layer::volume].g), mean.value, 1e-6);
}

}  // namespace
}  // namespace tempolux
