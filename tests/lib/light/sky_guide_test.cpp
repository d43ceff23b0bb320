// The guide of light samples of the sky: densities are those of the samples, and means do not depend on the guide.
#include "lib/light/sky_guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/pi.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

constexpr Vec3 kUp{0, 1, 0};
const Vec3 kWindow = normalize(Vec3{0.8f, 0.5f, -0.3f});

bool through(Vec3 window, Vec3 d) { return dot(d, window) > 0.97f; }
bool through_window(Vec3 d) { return through(kWindow, d); }

/// Places along the x axis that see the sky through a window of 1.5 % of the sphere around a direction, and hits in it.
SkyGuide guide_through_window(Vec3 window = kWindow) {
  std::vector<SkyGuide::Place> places;
  std::vector<SkyGuide::Hit> hits;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    places.push_back({{float(i) / 4096, 0, 0}, kUp});
    const PathRandom random(3, i);
    for (std::uint32_t k = 0; k < 4; ++k)
      if (const Vec3 d = Vec3(sample_hemisphere_cos(random.get2(k, Purpose::test))); through(window, {d.x, d.z, d.y}))
        hits.push_back({i, {d.x, d.z, d.y}, 1, 1});
  }
  return {places, hits, 4};
}

struct Mean {
  double mean = 0, error = 0;
};
template <class Value>
Mean mean_of(std::uint32_t n, Value value) {
  double sum = 0, squares = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double x = value(PathRandom(5, i));
    sum += x;
    squares += x * x;
  }
  return {sum / n, std::sqrt(std::max(0.0, squares / n - sum / n * sum / n) / n)};
}

constexpr std::uint32_t kSamples = 1 << 17;

/// A sky with a gradient and a bright spot outside of the window.
Environment sky() {
  Environment map;
  map.width = 16;
  map.height = 12;
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      map.radiance.push_back(x == 12 && y == 3 ? Rgb(50.0f) : Rgb(0.2f + 0.05f * float(x % 4)));
  return map;
}

const SkyGuide::Grid* grid_at(const SkyGuide& guide, Vec3 position, Vec3 normal) {
  return guide.grid_of(guide.at(position, normal));
}

// A window away from azimuth 0, and a window across it. Seen to fail: the box of the hits begins before the widest gap.
TEST(SkyGuide, DensityIntegratesToOneAndIsThatOfTheSamples) {
  for (const Vec3 direction : {kWindow, normalize(Vec3{0.8f, 0.5f, 0})}) {
    const SkyGuide guide = guide_through_window(direction);
    const SkyGuide::Grid* const grid = grid_at(guide, {0.3f, 0, 0}, kUp);
    ASSERT_NE(grid, nullptr);
    // Directions of equal solid angle. Its cells cut the edges of those of the grid, so the sum errs by less than .01.
    constexpr int kFine = 2048;
    double sum = 0;
    for (int row = 0; row < kFine; ++row)
      for (int column = 0; column < 2 * kFine; ++column) {
        const double y = 1 - 2 * (row + 0.5) / kFine, phi = kPiD * (column + 0.5) / kFine,
                     across = std::sqrt(1 - y * y);
        sum += grid->pdf_solid_angle({float(across * std::cos(phi)), float(y), float(across * std::sin(phi))});
      }
    EXPECT_NEAR(sum / (2.0 * kFine * kFine) * 4 * kPiD, 1, 0.01);
    // The mean of 1 / pdf over a region is its solid angle. 64 hits or more in 200 cells leave a cell without a hit in
    // and around it with the chance exp(-9 * 64 / 200) = .06; cells at the window's edge have fewer neighbours.
    const Mean window = mean_of(1 << 16, [&](const PathRandom& random) {
      const Vec3 d =
          grid->sample(unit_double(random.bits(0, Purpose::test, 0)), unit_double(random.bits(0, Purpose::test, 1)));
      EXPECT_NEAR(length(d), 1, 1e-5);
      return through(direction, d) ? 1 / grid->pdf_solid_angle(d) : 0;
    });
    EXPECT_LT(window.mean, 2 * kPiD * 0.03 + 3 * window.error);
    EXPECT_GT(window.mean, 0.9 * 2 * kPiD * 0.03);
  }
}

TEST(SkyGuide, HasNoGridWhereMuchIsSeenOrNothing) {
  const SkyGuide guide = guide_through_window();
  EXPECT_EQ(grid_at(guide, {}, {0, -1, 0}), nullptr);  // no place faces down
  EXPECT_EQ(guide.at({}, {}), nullptr);
  std::vector<SkyGuide::Place> places(200, {{}, kUp});
  std::vector<SkyGuide::Hit> hits;
  for (std::uint32_t i = 0; i < 200; ++i) hits.push_back({i, kUp, 1, 1});
  for (const int rays : {1, 4, 9}) EXPECT_EQ(grid_at(SkyGuide(places, hits, rays), {}, kUp), nullptr) << rays;
  EXPECT_NE(grid_at(SkyGuide(places, hits, 11), {}, kUp), nullptr);  // less than a tenth
}

/// Rays by cos / pi that see a sky of radiance 1 with the chance f estimate the irradiance pi f. Rays of twice the pdf
/// have the share 1/2, and twice as many are hits. Seen to fail: weights that leave out the share.
TEST(SkyGuide, EstimatesIrradiance) {
  for (const float share : {1.0f, 0.5f}) {
    std::vector<SkyGuide::Place> places(1000, {{}, kUp, 0.25f});
    std::vector<SkyGuide::Hit> hits;
    for (std::uint32_t i = 0; i < 1000; i += share < 1 ? 10 : 20) hits.push_back({i, kWindow, share, share});
    const SkyGuide guide(places, hits, 2);
    const SkyGuide::Part* const part = guide.at({}, kUp);
    ASSERT_NE(part, nullptr);
    EXPECT_NEAR(part->irradiance, kPiD * 50 / 2000, 1e-6);
    EXPECT_NEAR(part->lamps, 0.5, 1e-6);
  }
}

/// Beside a lamp, a guide that sees the sky through a window only draws the sky more seldom than a choice that takes
/// the sky unshadowed.
TEST(SkyGuide, SkyBehindWallsIsDrawnSeldom) {
  Environment map = sky();
  LightScene scene;
  scene.frame.environment = &map;
  scene.add(PunctualLight::Kind::point, Rgb(1.0f), {0, 2, 1}, {});
  const Lights plain = scene.lights(), guided = plain.guided(std::make_shared<SkyGuide>(guide_through_window()));
  const auto sky_share = [](const Lights& lights) {
    return mean_of(1 << 14,
                   [&](const PathRandom& random) {
                     LightSample s;
                     lights.sample({0.3f, 0, 0}, kUp, random.get2(0, Purpose::light_point), s);
                     return double(s.distant);
                   })
        .mean;
  };
  EXPECT_LT(sky_share(guided), sky_share(plain) / 1.2);
}

/// Irradiance of the whole sky, which the guide misleads about, and of the window alone.
TEST(SkyGuide, MeansAreTheSameAndWindowsHaveLessNoise) {
  const Environment map = sky();
  const auto irradiance = [](const Lights& lights, bool window) {
    return mean_of(kSamples, [&](const PathRandom& random) {
      LightSample s;
      const Vec3 place{0.3f, 0, 0};
      if (!lights.sample(place, kUp, random.get2(0, Purpose::light_point), s)) return 0.0;
      if (s.distant) { EXPECT_NEAR(pdf_environment(lights, place, kUp, s.wi) / s.pdf_solid_angle, 1, 1e-3); }
      return window && !(s.distant && through_window(s.wi))
                 ? 0.0
                 : double(s.facing_irradiance.g) * std::max(0.0f, dot(s.wi, kUp));
    });
  };
  // The window's light is measured without the lamp: beside it the guide draws the sky more seldom.
  for (const bool window : {false, true}) {
    LightScene scene;
    scene.frame.environment = &map;
    if (!window) scene.add(PunctualLight::Kind::point, Rgb(3.0f), {0, 2, 1}, {});
    const Lights plain = scene.lights(), guided = plain.guided(std::make_shared<SkyGuide>(guide_through_window()));
    const Mean a = irradiance(plain, window), b = irradiance(guided, window);
    EXPECT_NEAR(a.mean, b.mean, 3 * std::hypot(a.error, b.error)) << window;
    // The guide leaves the sky at least .2 of the samples in place of at most .8, and radiance kUnguidedShare of them.
    const double square = a.error * a.error + (window ? 0 : a.mean * a.mean / kSamples);
    EXPECT_LT(b.error * b.error, (window ? 0.25 : 4 / kUnguidedShare) * square);
  }
}

}  // namespace
}  // namespace tempolux
