// Warps of the unit square: their plain arithmetic against the library's functions.
#include "lib/core/sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"

namespace tempolux {
namespace {

float ulp(double value) { return std::nextafter(float(std::abs(value)), 2.0f) - float(std::abs(value)); }

TEST(SinCosEighth, IsWithinAHairOfOneUlpOfTheTrueValue) {
  for (int i = -100000; i <= 100000; ++i) {
    const float x = kPi / 4 * (float(i) / 100000);
    const SinCos got = sin_cos_eighth(x);
    EXPECT_NEAR(got.sin, std::sin(double(x)), 1.1 * ulp(std::sin(double(x)))) << x;
    EXPECT_NEAR(got.cos, std::cos(double(x)), 1.1 * ulp(std::cos(double(x)))) << x;
  }
}

/// Shirley & Chiu's map as published, in double.
TEST(SampleDiscConcentric, IsThePublishedMap) {
  const PathRandom random(1, 1);
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test), got = sample_disc_concentric(u);
    const double a = 2 * double(u.x) - 1, b = 2 * double(u.y) - 1;
    const bool flat = std::abs(a) > std::abs(b);
    const double r = flat ? a : b, phi = flat ? M_PI / 4 * b / a : M_PI / 2 - M_PI / 4 * a / b;
    // Rounding of 2u - 1 (2^-24), of the angle and of its functions: below 4 ulp of 1.
    EXPECT_NEAR(got.x, r * std::cos(phi), 0x1p-22) << u.x << " " << u.y;
    EXPECT_NEAR(got.y, r * std::sin(phi), 0x1p-22) << u.x << " " << u.y;
  }
}

TEST(SampleDiscConcentric, CoversCentreAndCorners) {
  EXPECT_EQ(sample_disc_concentric({0.5f, 0.5f}), (Vec2{0, 0}));
  const Vec2 corner = sample_disc_concentric({0, 0});
  EXPECT_NEAR(corner.x, -std::sqrt(0.5f), 1e-7f);
  EXPECT_NEAR(corner.y, -std::sqrt(0.5f), 1e-7f);
}

}  // namespace
}  // namespace tempolux
