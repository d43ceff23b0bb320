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

bool through_window(Vec3 d) { return dot(d, kWindow) > 0.97f; }

/// Places along the x axis that see the sky through a window of 1.5 % of the sphere, and hits in it.
SkyGuide guide_through_window() {
  std::vector<SkyGuide::Place> places;
  std::vector<SkyGuide::Hit> hits;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    places.push_back({{float(i) / 4096, 0, 0}, kUp});
    const PathRandom random(3, i);
    for (std::uint32_t k = 0; k < 4; ++k)
      if (const Vec3 d = Vec3(sample_hemisphere_cos(random.get2(k, Purpose::test))); through_window({d.x, d.z, d.y}))
        hits.push_back({i, {d.x, d.z, d.y}, 1});
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

TEST(SkyGuide, DensityIntegratesToOneAndIsThatOfTheSamples) {
  const SkyGuide guide = guide_through_window();
  const SkyGuide::Grid* const grid = guide.at({0.3f, 0, 0}, kUp);
  ASSERT_NE(grid, nullptr);
  // Cells have equal solid angles, so the mean over their middles is the integral over 4 pi.
  double sum = 0;
  for (int row = 0; row < SkyGuide::kRows; ++row)
    for (int column = 0; column < SkyGuide::kColumns; ++column) {
      const double y = 1 - 2 * (row + 0.5) / SkyGuide::kRows, phi = 2 * kPiD * (column + 0.5) / SkyGuide::kColumns,
                   across = std::sqrt(1 - y * y);
      sum += grid->pdf_solid_angle({float(across * std::cos(phi)), float(y), float(across * std::sin(phi))});
    }
  EXPECT_NEAR(sum / (SkyGuide::kRows * SkyGuide::kColumns) * 4 * kPiD, 1, 1e-5);
  // The mean of 1 / pdf over a region is its solid angle.
  const Mean window = mean_of(1 << 16, [&](const PathRandom& random) {
    const Vec3 d =
        grid->sample(unit_double(random.bits(0, Purpose::test, 0)), unit_double(random.bits(0, Purpose::test, 1)));
    EXPECT_NEAR(length(d), 1, 1e-5);
    return through_window(d) ? 1 / grid->pdf_solid_angle(d) : 0;
  });
  EXPECT_NEAR(window.mean, 2 * kPiD * 0.03, 3 * window.error);
}

TEST(SkyGuide, HasNoGridWhereMuchIsSeenOrNothing) {
  const SkyGuide guide = guide_through_window();
  EXPECT_EQ(guide.at({}, {0, -1, 0}), nullptr);  // no place faces down
  EXPECT_EQ(guide.at({}, {}), nullptr);
  std::vector<SkyGuide::Place> places(200, {{}, kUp});
  std::vector<SkyGuide::Hit> hits;
  for (std::uint32_t i = 0; i < 200; ++i) hits.push_back({i, kUp, 1});
  for (const int rays : {1, 4, 9}) EXPECT_TRUE(SkyGuide(places, hits, rays).empty()) << rays;
  EXPECT_FALSE(SkyGuide(places, hits, 11).empty());  // less than a tenth
}

/// Irradiance of the whole sky, which the guide misleads about, and of the window alone.
TEST(SkyGuide, MeansAreTheSameAndWindowsHaveLessNoise) {
  const Environment map = sky();
  LightScene scene;
  scene.frame.environment = &map;
  scene.add(PunctualLight::Kind::point, Rgb(3.0f), {0, 2, 1}, {});
  const Lights plain = scene.lights(), guided = plain.guided(std::make_shared<SkyGuide>(guide_through_window()));
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
  for (const bool window : {false, true}) {
    const Mean a = irradiance(plain, window), b = irradiance(guided, window);
    EXPECT_NEAR(a.mean, b.mean, 3 * std::hypot(a.error, b.error)) << window;
    // The mean square is at most 1 / kUnguidedShare times that without a guide.
    const double square = a.error * a.error + (window ? 0 : a.mean * a.mean / kSamples);
    EXPECT_LT(b.error * b.error, (window ? 0.25 : 1 / kUnguidedShare) * square);
  }
}

}  // namespace
}  // namespace tempolux
