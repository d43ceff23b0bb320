// Cells of the grid are found again, directions of the sky have the density they are drawn with, numbers and directions
// agree.
#include "lib/light/light_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

/// A sky with a sun of one pixel that gives half of the light, turned by 1 rad.
Environment sunny() {
  Environment sky;
  sky.width = 64;
  sky.height = 32;
  sky.rotation_rad = 1;
  sky.radiance.assign(64 * 32, Rgb(0.5f, 0.7f, 1.0f));
  for (int i = 0; i < 64 * 10; ++i) sky.radiance[std::size_t(i + 64 * 20)] = Rgb(0.1f);
  sky.radiance[64 * 9 + 17] = Rgb(900.0f);
  return sky;
}

LightGrid::Cell uneven_cell() {
  LightGrid::Cell cell;
  cell.sky = 1;
  double sum = 0, all = 0;
  const auto weight = [](std::uint32_t k) { return 0.1 + (k * 7919u % 13u == 0 ? 5.0 : 0.0); };
  for (std::uint32_t k = 0; k < LightGrid::kParts; ++k) all += weight(k);
  for (std::uint32_t k = 0; k < LightGrid::kParts; ++k) cell.end[k] = float((sum += weight(k)) / all);
  cell.end.back() = 1;
  return cell;
}

/// numbers_of() is the inverse of sample(). Angles of directions hold to 1e-7, which the sun's pixel, 1e-3 of the sky
/// that fills a quarter of the numbers, turns into 1e-4.
TEST(EnvironmentNumbers, AreTheInverseOfSampling) {
  const Environment sky = sunny();
  const EnvironmentLight light(sky, 1);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const PathRandom random(3, i);
    const Vec2 u = random.get2(0, Purpose::test);
    EnvironmentLight::Sample sample;
    ASSERT_TRUE(light.sample(double(u.x), double(u.y), sample));
    const Vec2 back = light.numbers_of(sample.direction);
    EXPECT_NEAR(back.x, u.x, 2e-4) << i;
    EXPECT_NEAR(back.y, u.y, 2e-4) << i;
  }
}

/// density is that of sky_density() but where a direction lies on the border of two parts, which rounding decides: 1 in
/// 500.
TEST(LightGrid, SamplesHaveTheirDensity) {
  const Environment sky = sunny();
  const LightGrid grid(1, &sky);
  const LightGrid::Cell cell = uneven_cell();
  int apart = 0;
  double mean = 0;
  constexpr int kCount = 20000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const PathRandom random(4, i);
    const Vec2 u = random.get2(0, Purpose::test);
    EnvironmentLight::Sample sample;
    double density;
    ASSERT_TRUE(grid.sample_sky(cell, u.x, u.y, sample, density));
    apart += std::abs(grid.sky_density(cell, sample.direction) / density - 1) > 1e-3;
    mean += double(sample.radiance.g) / density / kCount;
  }
  EXPECT_LT(apart, kCount / 500);
  // Radiance over density is known by its integral, within 4 standard errors of about 1.2 times the mean each.
  EXPECT_NEAR(mean / grid.sky()->integral().g, 1, 4 * 1.2 / std::sqrt(double(kCount)));
}

TEST(LightGrid, FindsItsCellsAndNoOthers) {
  LightGrid grid(0.5f, nullptr);
  const Vec3 up{0, 1, 0};
  const std::uint64_t here = grid.key({0.1f, 0.2f, -0.3f}, up);
  ASSERT_NE(here, 0u);
  EXPECT_EQ(LightGrid::beside(here, 0, 1), grid.key({0.6f, 0.2f, -0.3f}, up));
  EXPECT_EQ(LightGrid::beside(here, 2, -1), grid.key({0.1f, 0.2f, -0.8f}, up));
  EXPECT_NE(here, grid.key({0.1f, 0.2f, -0.3f}, {0, -1, 0}));
  EXPECT_EQ(grid.key({1e9f, 0, 0}, up), 0u);
  grid.set({here}, {LightGrid::Cell{.sky = 0.25f, .suns = 0, .end = {}}});
  ASSERT_NE(grid.find({0.2f, 0.3f, -0.1f}, {0.1f, 0.9f, 0}), nullptr);
  EXPECT_EQ(grid.find({0.2f, 0.3f, -0.1f}, up)->sky, 0.25f);
  EXPECT_EQ(grid.find({0.6f, 0.3f, -0.1f}, up), nullptr);
  EXPECT_EQ(grid.find({0.2f, 0.3f, -0.1f}, Vec3{}), nullptr);
  EXPECT_EQ(grid.find({1e9f, 0, 0}, up), nullptr);
}

}  // namespace
}  // namespace tempolux
