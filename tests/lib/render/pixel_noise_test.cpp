// Numbers of samples of a pixel, against the formulas of docs/pixels.md.
#include "lib/render/pixel_noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux {
namespace {

TEST(SampleVariance, OfFourNumbers) {
  EXPECT_DOUBLE_EQ(sample_variance(4, 1 + 2 + 3 + 4, 1 + 4 + 9 + 16), 5.0 / 3);
  EXPECT_EQ(sample_variance(1, 3, 9), 0);
}

/// e = pixel_error sqrt(min(L, mean) mean + (mean / 10)^2).
TEST(AllowedError, GrowsWithTheRootOfRadianceUpToTheMean) {
  EXPECT_DOUBLE_EQ(allowed_error(0, 2, 0.5), 0.1);
  EXPECT_DOUBLE_EQ(allowed_error(1, 2, 0.5), 0.5 * std::sqrt(2.04));
  EXPECT_DOUBLE_EQ(allowed_error(100, 2, 0.5), 0.5 * std::sqrt(4.04));
}

/// A part of cost 4 whose standard deviation is 12 e gets 12 samples. Twice the deviation needs 2^(7/8) times as many.
TEST(WantedSamples, FollowTheFormula) {
  EXPECT_NEAR(wanted_samples(12, 4, 1), 12, 0.05);
  EXPECT_DOUBLE_EQ(wanted_samples(24, 4, 1) / wanted_samples(12, 4, 1), std::pow(2, 7.0 / 8));
  EXPECT_EQ(wanted_samples(12, 4, 0), 0);
}

/// The variance of a mean is variance / samples. With the smaller error it is the same for light of five times the
/// variance.
TEST(ErrorForVariance, LeavesTheSameNoise) {
  const double noise = 9 / wanted_samples(3, 1, 0.1),
               same = 5 * 9 / wanted_samples(std::sqrt(5.0) * 3, 1, 0.1 * error_for_variance(5));
  EXPECT_NEAR(same, noise, 1e-12);
}

/// x = (1 - k/2) / k with k = 7/8.
TEST(ErrorExponent, IsThatOfTheFormula) { EXPECT_DOUBLE_EQ(error_exponent(), 9.0 / 14); }

/// In a picture of 5 x 4 pixels: 3 neighbours at a corner, 8 inside, and all 19 others within four columns and rows.
TEST(PixelsAround, EndAtThePicture) {
  const auto count = [](int x, int y, int reach) {
    int pixels = 0;
    for_each_around(5, 4, x, y, reach, [&](std::size_t pixel, int i, int j) {
      EXPECT_EQ(pixel, std::size_t(j * 5 + i));
      ++pixels;
    });
    return pixels;
  };
  EXPECT_EQ(count(0, 0, 1), 3);
  EXPECT_EQ(count(2, 1, 1), 8);
  EXPECT_EQ(count(4, 3, 4), 19);
}

}  // namespace
}  // namespace tempolux
