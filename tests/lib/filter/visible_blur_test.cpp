// Contrast sensitivity, eye movement and the blur that follows from them, against docs/methods/formulas.md.
#include "lib/filter/visible_blur.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tempolux {
namespace {

TEST(VisibleBlur, SensitivityIsThatOfTheTable) {
  EXPECT_NEAR(VisibleBlur::sensitivity(1, 0.15), 51.294, 0.001);
  EXPECT_NEAR(VisibleBlur::sensitivity(4, 1), 225.961, 0.001);
  EXPECT_NEAR(VisibleBlur::sensitivity(2, 20), 0.074, 0.001);
  const double cutoffs[][2] = {{0.15, 26.3347}, {0.5, 20.8638}, {1, 16.0878}, {2, 10.9234}, {5, 5.4202}, {10, 2.9296}, {20, 1.5232}, {80, 0.3817}};
  for (const auto& [v, expected] : cutoffs) EXPECT_NEAR(VisibleBlur::cutoff(v), expected, 2e-4) << v;
}

TEST(VisibleBlur, TheEyeFollowsAsWellAsItCan) {
  EXPECT_NEAR(VisibleBlur::retinal(0), 0.15, 1e-12);
  EXPECT_NEAR(VisibleBlur::retinal(0.8333), 0.15, 1e-12);   // 0 but for the floor
  EXPECT_NEAR(VisibleBlur::retinal(5), 0.75, 1e-12);
  EXPECT_NEAR(VisibleBlur::retinal(50), 8.85, 1e-12);
  EXPECT_NEAR(VisibleBlur::retinal(100), 20, 1e-12);
}

/// At 30 pixels per degree; the table has four speeds to an octave: 6 % of the value at most.
TEST(VisibleBlur, OfWhatIsFollowedIsThatOfTheTable) {
  const VisibleBlur blur(30);
  const float expected[][2] = {{1, 0.213f}, {5, 0.309f}, {10, 0.456f}, {20, 0.765f}, {50, 1.716f}};
  for (const auto& [speed, sigma] : expected) EXPECT_NEAR(blur.sigma(30 * speed), sigma, 0.16f * sigma) << speed;
  EXPECT_FALSE(blur.hides(30 * 7.0f));   // 8.68 deg/s
  EXPECT_TRUE(blur.hides(30 * 10.5f));
  EXPECT_THROW(VisibleBlur(0), std::invalid_argument);
}

}  // namespace
}  // namespace tempolux
