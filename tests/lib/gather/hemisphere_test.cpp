// Irradiance and gradients from one hemisphere of radiance and distances, against closed forms.
#include "lib/gather/hemisphere.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"

namespace tempolux {
namespace {

TEST(Hemisphere, UniformLight) {
  Hemisphere sky;
  sky.reset(13, 40);
  for (Rgb& l : sky.radiance) l = Rgb(0.7f);
  for (float& inverse : sky.inverse_distance) inverse = 3;
  IrradianceRecord record;
  sky.irradiance_and_rotational_gradient(Frame({0, 0, 1}), record);
  EXPECT_NEAR(record.irradiance.g, 0.7 * M_PI, 1e-5);
}

/// Cells whose light is 0 or 2 at random, independently. The irradiance has the variance (pi/(M N))^2 M N, and the
/// square of the noise has the same mean. With 4000 hemispheres each mean square is within 3 sqrt(2/4000) = 7 %. The
/// noise of uniform light is 0.
TEST(Hemisphere, NoiseHasTheVarianceOfTheIrradiance) {
  constexpr int kRings = 3, kSectors = 10, kMany = 4000;
  Hemisphere sky;
  sky.reset(kRings, kSectors);
  double mean = 0, square = 0;
  for (int i = 0; i < kMany; ++i) {
    for (std::size_t c = 0; c < sky.radiance.size(); ++c)
      sky.radiance[c] = Rgb(float(mix64(mix64(std::uint64_t(i)) + c) & 2));
    const double noise = double(sky.noise(mix64(~std::uint64_t(i))).g);
    mean += noise / kMany, square += noise * noise / kMany;
  }
  const double variance = M_PI * M_PI / (kRings * kSectors);
  EXPECT_NEAR(square / variance, 1, 0.07);
  EXPECT_NEAR(mean, 0, 3 * std::sqrt(variance / kMany));
  for (Rgb& l : sky.radiance) l = Rgb(0.7f);
  EXPECT_EQ(sky.noise(1).g, 0);
}

/// All cells on one side of a meridian are lit: only cells along the border get further rays. Next to the border three
/// of eight neighbours are dark, and the mean of all cells is a half: sqrt(15/64) / (1/2) = 0.97, one further ray.
/// Other cells get none.
TEST(Hemisphere, FurtherRaysFallWhereLightIsUneven) {
  constexpr int kRings = 10, kSectors = 30;
  Hemisphere sky;
  sky.reset(kRings, kSectors);
  for (int j = 0; j < kRings; ++j)
    for (int k = 0; k < kSectors / 2; ++k) sky.radiance[std::size_t(j * kSectors + k)] = Rgb(2.0f);
  std::vector<std::uint8_t> counts;
  sky.further_rays(counts);
  for (int j = 0; j < kRings; ++j)
    for (int k = 0; k < kSectors; ++k) {
      const bool border = k % (kSectors / 2) == 0 || k % (kSectors / 2) == kSectors / 2 - 1;
      EXPECT_EQ(int(counts[std::size_t(j * kSectors + k)]), border ? 1 : 0) << j << ' ' << k;
    }
  for (Rgb& l : sky.radiance) l = Rgb(0.3f);
  sky.further_rays(counts);
  for (const int count : counts) EXPECT_EQ(count, 0);
}

/// The number of a cell's further rays does not depend on the cell's own ray, but on the rays of other cells.
TEST(Hemisphere, ACellsOwnRayHasNoSayInItsFurtherOnes) {
  Hemisphere sky;
  sky.reset(5, 16);
  for (std::size_t c = 0; c < sky.radiance.size(); ++c) sky.radiance[c] = Rgb(float(mix64(c) % 100 < 15 ? 40 : 1));
  std::vector<std::uint8_t> before, after;
  sky.further_rays(before);
  bool others = false;
  for (std::size_t c = 0; c < sky.radiance.size(); ++c) {
    const Rgb own = sky.radiance[c];
    for (const float value : {0.0f, 7.0f, 1e5f}) {
      sky.radiance[c] = Rgb(value);
      sky.further_rays(after);
      EXPECT_EQ(after[c], before[c]) << c << ' ' << value;
      others |= after != before;
    }
    sky.radiance[c] = own;
  }
  EXPECT_TRUE(others);
}

}  // namespace
}  // namespace tempolux
