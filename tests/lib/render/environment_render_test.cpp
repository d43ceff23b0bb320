// Environments against closed forms: furnaces, open planes, layers, photons that arrive and escape.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/photon/photon_trace.h"
#include "lib/render/path_tracer.h"
#include "tests/support/closed_box.h"
#include "tests/support/layers.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::total;

const Environment& uniform(float radiance) {
  static std::vector<std::unique_ptr<Environment>> kept;
  kept.push_back(std::make_unique<Environment>());
  kept.back()->radiance = {Rgb(radiance)};
  return *kept.back();
}

/// The scene under an environment, ready to be traced.
struct Lit {
  HandMadeScene scene;
  SceneFrame frame;
  Tracer tracer;
  Lights lights;
  Lit(HandMadeScene scene_, const Environment& environment)
      : scene(std::move(scene_)),
        frame(with(scene.frame(), environment)),
        tracer(frame),
        lights(frame, build_emission_table({&frame, 1})) {}
  static SceneFrame with(SceneFrame frame, const Environment& environment) {
    frame.environment = &environment;
    return frame;
  }
  Layers seen(Vec3 eye, Vec3 towards, std::uint64_t pixel, std::uint32_t sample) const {
    RayCounts counts;
    return trace_eye_path({tracer, lights}, {eye, normalize(towards), 0, INFINITY}, PixelRandom(5, pixel, sample),
                          nullptr, counts);
  }
};

HandMadeScene plane(const Material& material) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, material);
  return scene;
}

// The radiance is rho L, and all of it is direct. Light sampling and scattering are joined: a sample's deviation is
// below 1, so 4096 samples of a scrambled Sobol sequence leave far less than 0.3 %.
TEST(Environment, APlaneUnderAUniformSkyShowsRhoTimesL) {
  const Lit scene(plane(matte(Rgb(0.5f))), uniform(3));
  double sum = 0, direct = 0;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const Layers seen = scene.seen({0.1f, 1, 0.2f}, {0.2f, -1, 0.1f}, 1, i);
    sum += total(seen) / 4096;
    direct += double(seen[Layer::direct].g) / 4096;
  }
  EXPECT_NEAR(sum, 1.5, 0.003 * 1.5);
  EXPECT_EQ(sum, direct);
}

// Under a sky of 3 and a sun of 30 W/m^2 at 60 degrees the radiance is rho (3 + 15 / pi), all of it direct, whether
// each light has its own ray or one of the two is drawn. The draw is nearly all of the noise: with one ray for each the
// deviation is less than a quarter.
TEST(Environment, ASunWithARayOfItsOwnGivesTheSameLightWithLessNoise) {
  HandMadeScene made = plane(matte(Rgb(0.5f)));
  SceneFrame frame = Lit::with(made.frame(), uniform(3));
  PlacedLight sun;
  sun.light.kind = PunctualLight::Kind::directional;
  sun.light.intensity = Rgb(30.0f);
  sun.direction = normalize(Vec3{std::sqrt(3.0f), -1, 0});
  frame.lights.push_back(sun);
  const Tracer tracer(frame);
  Lights lights(frame, build_emission_table({&frame, 1}));
  double deviation[2];
  for (const bool apart : {false, true}) {
    const RenderScene scene{tracer, lights, apart};
    double sum = 0, square = 0;
    constexpr int kSamples = 4096;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      RayCounts counts;
      const Layers seen = trace_eye_path(scene, {{0.1f, 1, 0.2f}, normalize(Vec3{0.2f, -1, 0.1f}), 0, INFINITY},
                                         PixelRandom(5, 1, i), nullptr, counts);
      EXPECT_EQ(total(seen), double(seen[Layer::direct].g));
      sum += total(seen);
      square += total(seen) * total(seen);
    }
    const double mean = sum / kSamples, exact = 0.5 * (3 + 15 / 3.14159265);
    EXPECT_NEAR(mean, exact, 0.003 * exact) << apart;
    deviation[apart] = std::sqrt(std::max(0.0, square / kSamples - mean * mean));
  }
  EXPECT_LT(deviation[1], deviation[0] / 4);
}

// An open box of reflectance 1 under a sky of 1 shows 1 everywhere, after any number of bounces. Russian roulette ends
// 0.2 % of the paths at each bounce; 4 bounces are enough for nearly all paths that stay in the box.
TEST(Environment, AWhiteBowlUnderAUniformSkyIsAFurnace) {
  HandMadeScene scene;
  const Material white = matte(Rgb(1.0f));
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
  scene.add_quad({-1, 0, -1}, {1, 0, -1}, {1, 1, -1}, {-1, 1, -1}, white);
  scene.add_quad({-1, 0, 1}, {-1, 0, -1}, {-1, 1, -1}, {-1, 1, 1}, white);
  const Lit lit(std::move(scene), uniform(1));
  double sum = 0, square = 0;
  constexpr int kCount = 1 << 15;
  for (int i = 0; i < kCount; ++i) {
    const PathRandom random(1, std::uint64_t(i));
    const Vec2 u = random.get2(0, Purpose::test);
    const double value = total(lit.seen(
        {0.5f, 2, 0.5f}, Vec3{2 * u.x - 1, 0.2f, 2 * u.y - 1} * 0.9f - Vec3{0.5f, 2, 0.5f}, std::uint64_t(i), 0));
    sum += value / kCount;
    square += value * value / kCount;
  }
  const double sigma = std::sqrt((square - sum * sum) / kCount);
  EXPECT_LT(4 * sigma, 0.012);
  EXPECT_NEAR(sum, 1, 0.003 + sigma);
}

TEST(Environment, SeenDirectlyIsEmissionWithoutCoverage) {
  const Lit scene(plane(matte(Rgb(0.5f))), uniform(3));
  const Layers up = scene.seen({0, 1, 0}, {0, 1, 0}, 1, 0);
  EXPECT_EQ(up[Layer::emission].g, 3);
  EXPECT_EQ(total(up), 3);
  EXPECT_EQ(up.coverage, 0);
  Material mirror;
  mirror.metallic = 1;
  mirror.roughness = 0;
  const Lit reflecting(plane(mirror), uniform(3));
  const Layers seen = reflecting.seen({0, 1, 0}, {0, -1, 0}, 1, 0);
  EXPECT_NEAR(seen[Layer::specular].g, 3, 1e-4f);
  EXPECT_EQ(seen.coverage, 1);
}

// On the open plane photons of kind direct carry pi L A to either side; light that is not absorbed escapes. 2^17 Halton
// points start in a disc of pi R^2 = 2 pi m^2, of which the plane of 4 m^2 covers 2 / (2 pi) in the mean over
// directions.
TEST(Environment, PhotonsOnAnOpenPlaneHaveTheDensityOfTheSky) {
  const Lit scene(plane(matte(Rgb(0.5f))), uniform(3));
  PhotonOptions options;
  options.photon_count = 1 << 17;
  const PhotonTracer photons(scene.tracer, scene.lights, options);
  double up = 0, down = 0, left = 0, indirect = 0;
  Rgbd emitted, escaped, absorbed;
  for (std::size_t b = 0; b < photons.batch_count(); ++b) {
    const PhotonBatch batch = photons.trace(b);
    emitted += batch.emitted;
    escaped += batch.escaped;
    absorbed += batch.absorbed;
    for (const formats::Photon& photon : batch.block.photons) {
      const auto n = formats::decode_normal(photon.normal);
      if (photon.kind != formats::PathKind::direct) indirect += double(photon.flux[1]);
      else (n[1] > 0 ? up : down) += double(photon.flux[1]);
      if (photon.position[0] < 0) left += double(photon.flux[1]);
    }
  }
  const double expected = M_PI * 3 * 4;
  EXPECT_NEAR(up, expected, 0.005 * expected);
  EXPECT_NEAR(down, expected, 0.005 * expected);
  EXPECT_NEAR(left, expected, 0.005 * expected);
  EXPECT_EQ(indirect, 0);
  EXPECT_NEAR(emitted.g, 4 * M_PI * 3 * M_PI * 2, 1e-3 * emitted.g);
  EXPECT_NEAR(escaped.g + absorbed.g, emitted.g, 1e-5 * emitted.g);
  EXPECT_NEAR(absorbed.g, 0.5 * (up + down), 0.01 * absorbed.g);
}

}  // namespace
}  // namespace tempolux
