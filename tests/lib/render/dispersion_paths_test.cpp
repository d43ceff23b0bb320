// Dispersion along whole paths: what is white stays white in the mean, and photons agree with camera paths.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/render/path_tracer.h"
#include "tests/support/layers.h"
#include "tests/support/materials.h"
#include "tests/support/mean.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::Mean;

Material flint(float roughness = 0) {
  Material m = test::glass(roughness, false, 1.62f);
  m.dispersion = 1;
  return m;
}

/// Mean radiance along one ray, by channel.
std::array<Mean, 3> look(HandMadeScene& scene, Vec3 from, Vec3 towards, int samples) {
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  RayCounts counts;
  std::array<Mean, 3> means;
  for (int i = 0; i < samples; ++i) {
    const Rgb seen = sum_of_layers<float>(trace_eye_path({tracer, lights}, {from, normalize(towards), 0, INFINITY},
                                                         PixelRandom(5, 0, std::uint32_t(i)), nullptr, counts));
    for (int c = 0; c < 3; ++c) means[std::size_t(c)].add(double(seen[c]));
  }
  return means;
}

// A slab before a white screen, seen at right angles: all wavelengths go straight, so its colour is white, and its
// light is that of the Fresnel series (1 - F) / (1 + F). F changes with the wavelength, by which the channels differ:
// n is 1.60 to 1.67 in the middles of red and blue, F .053 to .063, so that red is 1 % above, blue 1 % below. Seen to
// fail with the colour taken at each boundary.
TEST(DispersionPaths, ASlabSeenStraightIsWhite) {
  HandMadeScene scene;
  scene.add_open_box({-4, -4, -0.1f}, {4, 4, 0.1f}, flint());
  scene.add_quad({-40, -40, -3}, {40, -40, -3}, {40, 40, -3}, {-40, 40, -3}, matte(Rgb(0.0f), Rgb(1.0f)));
  const double f = std::pow(0.62 / 2.62, 2), expected = (1 - f) / (1 + f);
  const std::array<Mean, 3> seen = look(scene, {0, 0, 1.1f}, {0, 0, -1}, 40000);
  for (const Mean& channel : seen) {
    EXPECT_NEAR(channel.mean(), expected, 0.012 + 3 * channel.sigma());
    EXPECT_LT(channel.sigma(), 0.008);
  }
  EXPECT_NEAR((seen[0].mean() + seen[1].mean() + seen[2].mean()) / 3, expected, 0.006);
}

// A box of glass in a room of radiance 1 on all sides is invisible, smooth or rough, whatever the wavelength. Seen to
// fail with the colour taken at each boundary (2.2 times the light).
TEST(DispersionPaths, GlassInAFurnaceIsInvisible) {
  for (float roughness : {0.0f, 0.3f}) {
    HandMadeScene scene;
    scene.add_room({-2, -2, -2}, {2, 2, 2}, matte(Rgb(0.0f), Rgb(1.0f)));
    scene.add_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, flint(roughness));
    for (const Mean& channel : look(scene, {1.5f, 0.4f, 1.2f}, {-1.4f, -0.3f, -1}, 40000))
      EXPECT_NEAR(channel.mean(), 1, 0.005 + 3 * channel.sigma()) << roughness;
  }
}

// In the same room a path sees exactly white where the first face of smooth glass reflects it, which is the share F of
// the paths, .056 within 4 standard errors of 20000 paths; all others have the colour of a wavelength. Seen to fail
// with the colour taken by reflected paths, too.
TEST(DispersionPaths, ReflectedLightStaysWhite) {
  HandMadeScene scene;
  scene.add_room({-2, -2, -2}, {2, 2, 2}, matte(Rgb(0.0f), Rgb(1.0f)));
  scene.add_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, flint());
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  RayCounts counts;
  constexpr int kCount = 20000;
  int white = 0;
  for (std::uint32_t i = 0; i < kCount; ++i)
    white += sum_of_layers<float>(trace_eye_path({tracer, lights}, {{0, 0, 1.5f}, {0, 0, -1}, 0, INFINITY},
                                                 PixelRandom(5, 0, i), nullptr, counts)) == Rgb(1.0f);
  EXPECT_NEAR(double(white) / kCount, std::pow(0.62 / 2.62, 2), 0.0065);
}

/// Flux of caustic photons on an object between two x [m], by channel [W], and the mean x of each channel.
struct Caustic {
  Rgbd flux{0.0}, x{0.0};
  int count = 0;
};
Caustic caustic(HandMadeScene& scene, std::uint32_t object, float least, float most) {
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = 2000000;
  Caustic sum;
  for (const formats::Photon& photon : test::photons_of(PhotonTracer(tracer, lights, options))) {
    if (photon.object != object || photon.kind != formats::PathKind::caustic) continue;
    if (!(photon.position[0] > least && photon.position[0] < most)) continue;
    ++sum.count;
    for (int c = 0; c < 3; ++c) {
      sum.flux[c] += double(photon.flux[std::size_t(c)]);
      sum.x[c] += double(photon.flux[std::size_t(c)]) * double(photon.position[0]);
    }
  }
  for (int c = 0; c < 3; ++c) sum.x[c] /= sum.flux[c];
  return sum;
}

// A sun shines through a wedge of glass onto a floor 2 m below. The wedge is .1 m wide and its angle is 10 degrees:
// light of index n is turned by asin(n sin 10 deg) - 10 deg. The channels' light is equal, and each channel lies where
// its mean index sends it. 5000 photons pass: noise 2 % of the light and 1/15 of the distance from red to blue.
// Photons are a function of their number alone: the same paths, traced one by one, are the same. Seen to fail: photons
// of the d line (no difference of channels), and a wavelength drawn anew at the second boundary.
TEST(DispersionPaths, PhotonsMakeASpectrumOfSunlight) {
  HandMadeScene scene;
  const float a = 10 * kPi / 180, high = 0.1f * std::tan(a);
  const std::vector<Vec3> p{{0, 2, -0.1f}, {0.1f, 2, -0.1f}, {0.1f, 2 + high, -0.1f},
                            {0, 2, 0.1f},  {0.1f, 2, 0.1f},  {0.1f, 2 + high, 0.1f}};
  // the flat face looks down, the sloping face up to the sun
  scene.add(p, {{0, 1, 4}, {0, 4, 3}, {0, 3, 5}, {0, 5, 2}, {1, 2, 5}, {1, 5, 4}, {0, 2, 1}, {3, 4, 5}}, flint());
  const std::uint32_t floor =
      scene.add_quad({-0.9f, 0, 0.6f}, {0.9f, 0, 0.6f}, {0.9f, 0, -0.6f}, {-0.9f, 0, -0.6f}, matte(Rgb(0.0f)));
  // at right angles to the sloping face, so that this face turns nothing
  scene.add_sun(normalize(Vec3{std::sin(a), -std::cos(a), 0}), Rgb(1.0f));
  const Caustic seen = caustic(scene, floor, 0.55f, 0.75f);  // light that is reflected inside falls elsewhere
  RecordProperty("photons", seen.count);
  ASSERT_GT(seen.flux.g, 0.015);
  EXPECT_NEAR(seen.flux.r / seen.flux.g, 1, 0.04);
  EXPECT_NEAR(seen.flux.b / seen.flux.g, 1, 0.04);
  Rgbd index(0.0);
  for (int i = 0; i < 1000; ++i) {
    const HeroWavelength hero = hero_wavelength((float(i) + 0.5f) / 1000);
    for (int c = 0; c < 3; ++c) index[c] += double(hero.color[c] * index_at(flint(), hero.nm)) / 1000;
  }
  const auto shift = [&](double n) { return 2 * std::tan(std::asin(n * std::sin(double(a)))); };
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(seen.x[c] - seen.x.g, shift(index[c]) - shift(index.g), 0.2 * (shift(index.b) - shift(index.r))) << c;
  EXPECT_GT(seen.x.b - seen.x.r, 0.01);

  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = 2000, options.group_count = 1;
  const PhotonTracer photons(tracer, lights, options);
  const std::vector<formats::Photon> all = test::photons_of(photons);
  std::size_t at = 0;
  for (std::uint64_t path = 0; path < 2000; ++path)
    for (const formats::Photon& photon : photons.trace_paths(std::span(&path, 1)).block.photons) {
      ASSERT_LT(at, all.size());
      EXPECT_EQ(photon.flux, all[at].flux);
      EXPECT_EQ(photon.position, all[at++].position);
    }
  EXPECT_EQ(at, all.size());
}

// A lamp behind rough glass with dispersion. Light samples and scattered rays are joined at the same wavelength. The
// lamp's light through glass of the d line differs by less than 2 %. Seen to fail with the colour taken at each
// boundary.
TEST(DispersionPaths, RoughGlassKeepsTheLightOfALamp) {
  std::array<std::array<Mean, 3>, 2> seen;
  for (int i = 0; i < 2; ++i) {
    HandMadeScene scene;
    Material m = flint(0.3f);
    if (i == 0) m.dispersion = 0;
    scene.add_open_box({-1, -1, -0.1f}, {1, 1, 0.1f}, m);
    scene.add_quad({-0.2f, -0.2f, -1}, {0.2f, -0.2f, -1}, {0.2f, 0.2f, -1}, {-0.2f, 0.2f, -1},
                   matte(Rgb(0.0f), Rgb(1.0f)));
    seen[std::size_t(i)] = look(scene, Vec3{-0.3f, 0, 1}, {0.3f, 0, -1}, 60000);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const double plain = seen[0][c].mean(), sigma = std::hypot(seen[0][c].sigma(), seen[1][c].sigma());
    EXPECT_NEAR(seen[1][c].mean(), plain, 0.02 * plain + 3 * sigma) << c;
  }
}

}  // namespace
}  // namespace tempolux
