// tests/lib/aqm/vision_model_test.cpp -- the formulas of the model of vision against tables made
// independently, in double precision.
#include "lib/aqm/vision_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux::vision {
namespace {

// Tables have 3 digits after the point: half of the last one, or 1e-3 of the value where that is more.
void expect_as_printed(double value, double table) {
  EXPECT_NEAR(value, table, std::max(1e-3 * std::abs(table), 5.1e-4));
}

TEST(VisionModelTest, ContrastSensitivityIsTheTable) {
  const double speeds[] = {0.15, 0.5, 1, 2, 5, 10, 20, 80}, frequencies[] = {0.5, 1, 2, 4, 8, 16};
  const double table[8][6] = {{15.770, 51.294, 135.670, 237.282, 181.453, 26.528},
                              {24.129, 74.316, 176.238, 247.789, 122.457, 7.477},
                              {37.974, 108.186, 219.522, 225.961, 59.852, 1.050},
                              {63.849, 155.642, 231.210, 127.558, 9.706, 0.014},
                              {111.040, 169.555, 98.835, 8.396, 0.015, 0.000},
                              {138.604, 97.060, 11.899, 0.045, 0, 0},
                              {92.667, 13.647, 0.074, 0, 0, 0},
                              {0.086, 0, 0, 0, 0, 0}};
  for (int v = 0; v < 8; ++v)
    for (int f = 0; f < 6; ++f) expect_as_printed(contrast_sensitivity(frequencies[f], speeds[v]), table[v][f]);
  EXPECT_EQ(contrast_sensitivity(0, 0.15), 0);
}

// The peak of r^2 exp(-a r) lies at 2 / a = 45.9 / (2 pi .67 (1.7 v + 2)).
TEST(VisionModelTest, ContrastSensitivityPeaksAndEndsWhereTheTableSays) {
  const double rows[8][4] = {{0.15, 4.8352, 245.436, 26.3347}, {0.5, 3.8257, 248.288, 20.8638},
                             {1, 2.9468, 250.639, 16.0878},    {2, 2.0191, 231.231, 10.9234},
                             {5, 1.0384, 169.793, 5.4202},     {10, 0.5739, 141.141, 2.9296},
                             {20, 0.3029, 124.980, 1.5232},    {80, 0.0790, 91.171, 0.3817}};
  for (const auto& [speed, peak, highest, cutoff] : rows) {
    EXPECT_NEAR(contrast_sensitivity(peak, speed), highest, 1e-3 * highest);
    EXPECT_LT(contrast_sensitivity(peak * 1.05, speed), contrast_sensitivity(peak, speed));
    EXPECT_LT(contrast_sensitivity(peak / 1.05, speed), contrast_sensitivity(peak, speed));
    // S falls by up to e^(-16) per octave there: 1e-3 of the frequency is up to 2 % of S
    EXPECT_NEAR(contrast_sensitivity(cutoff, speed), 1, 1e-2);
  }
}

// Daly 1993 (docs/methods/vision.md): at 100 cd/m2, one square degree, half a metre S(4) = 163.58, and the peak is
// 171.8 at 4.70 cpd.
TEST(VisionModelTest, StaticSensitivityIsTheTable) {
  const auto at = [](double frequency) { return static_contrast_sensitivity(frequency, 100, 1, 0.5); };
  EXPECT_NEAR(at(4), 163.58, 1e-3 * 163.58);
  EXPECT_NEAR(at(4.705), 171.83, 1e-3 * 171.83);
  for (const double other : {0.5, 2.0, 4.0, 5.5, 12.0}) EXPECT_LT(at(other), at(4.705));
  EXPECT_EQ(at(0), 0);
  // A picture that holds more periods of a grating makes it more visible.
  EXPECT_GT(static_contrast_sensitivity(0.5, 100, 40, 0.6), 2 * static_contrast_sensitivity(0.5, 100, 1, 0.6));
}

TEST(VisionModelTest, EyesFollowWithAGainAndALimit) {
  const double table[][2] = {{0, -0.15}, {1, 0.03}, {5, 0.75}, {10, 1.65}, {20, 3.45}, {50, 8.85}, {100, 20}};
  for (const auto& [speed, retinal] : table) EXPECT_NEAR(tracked_retinal_speed(speed), retinal, 1e-12);
  EXPECT_NEAR(tracked_retinal_speed(0.15 / 0.18), 0, 1e-12);
  EXPECT_NEAR(0.82 * 97.378 + 0.15, 80, 1e-3);  // the knee
  EXPECT_EQ(retinal_speed(0.15 / 0.18, Gaze::track), 0.15);
  EXPECT_EQ(retinal_speed(0, Gaze::fixed), 0.15);
  EXPECT_EQ(retinal_speed(20, Gaze::fixed), 20);
  EXPECT_NEAR(retinal_speed(20, Gaze::track), 3.45, 1e-12);
}

TEST(VisionModelTest, ReceptorResponseIsTheTable) {
  const double table[][2] = {{1, 7.35294}, {10, 15.6865}, {100, 30.3691}, {1000, 50.5543}};
  for (const auto& [luminance, response] : table) EXPECT_NEAR(receptor_response(luminance), response, 1e-5 * response);
  EXPECT_EQ(receptor_response(0), 0);
  // d ln R / d ln L = .37 12.6 / (L^.37 + 12.6)
  EXPECT_NEAR(response_per_log_luminance(receptor_response(1)) / receptor_response(1), 0.343, 5e-4);
  EXPECT_NEAR(response_per_log_luminance(receptor_response(100)) / receptor_response(100), 0.258, 5e-4);
}

TEST(VisionModelTest, BandsPeakWhereTheyShould) {
  for (int band = 1; band <= 5; ++band) EXPECT_NEAR(band_filter(band, 4.0 / 3 * std::ldexp(1.0, -band)), 1, 1e-12);
  EXPECT_DOUBLE_EQ(band_frequency(1), 0.5);
  EXPECT_DOUBLE_EQ(band_frequency(2), 1.0 / 3);
  EXPECT_DOUBLE_EQ(band_frequency(5), 1.0 / 24);
  EXPECT_NEAR(mesa(0.5, 0.5), 0.5, 1e-15);
  EXPECT_EQ(mesa(1.0 / 3, 0.5), 1);
  EXPECT_NEAR(mesa(2.0 / 3, 0.5), 0, 1e-15);
}

TEST(VisionModelTest, BandsAndOrientationsAddUpToOne) {
  for (int i = 0; i <= 2000; ++i) {
    const double frequency = 2.0 / 3 * i / 2000;
    double sum = 0;
    for (int band = 1; band <= kBands; ++band) {
      EXPECT_GE(band_filter(band, frequency), -2e-15);
      sum += band_filter(band, frequency);
    }
    EXPECT_NEAR(sum, 1, 2e-15);
  }
  double corner = 0;
  for (int band = 1; band <= kBands; ++band) corner += band_filter(band, std::hypot(0.5, 0.5));
  EXPECT_NEAR(corner, 0.991, 5e-4);
  for (int i = 0; i < 360; ++i) {
    const double angle = i * std::acos(-1.0) / 180;
    double sum = 0;
    for (int o = 1; o <= kOrientations; ++o) sum += fan_filter(std::cos(angle - orientation_angle(o)));
    EXPECT_NEAR(sum, 1,
                1e-13);  // a polynomial of degree 6 with coefficients up to 48: 48 roundings of 1e-16, thrice
  }
}

TEST(VisionModelTest, ThresholdsRiseAsTheTableSays) {
  EXPECT_NEAR(threshold_elevation(0.1, 1), 1.03093, 1e-5);
  EXPECT_NEAR(threshold_elevation(1, 1), 6.00116, 1e-5);
  EXPECT_NEAR(threshold_elevation(10, 1), 60.0, 1e-3);
  EXPECT_NEAR(threshold_elevation(1, 0.7), 1.18921, 1e-5);
  EXPECT_NEAR(threshold_elevation(10, 0.7), 5.01386, 1e-5);
  EXPECT_EQ(threshold_elevation(0, 0.8), 1);
}

TEST(VisionModelTest, DetectionIsTheTable) {
  const auto probability = [](double thresholds) {
    return detection_probability(std::pow(thresholds, kPsychometricSlope));
  };
  EXPECT_NEAR(probability(1), 0.632, 5e-4);
  EXPECT_NEAR(probability(1.0978), 0.75, 1e-4);
  EXPECT_NEAR(probability(kHalfSeen), 0.5, 1e-4);
}

/// Tables of docs/methods/formulas.md: where sensitivity falls to 1, and what is slow on displays of 30 and 60 pixels
/// per degree.
TEST(VisionModelTest, SlowSpeedIsTheTable) {
  for (const auto& [speed, cutoff] : {std::pair{0.15, 26.3347}, {1.0, 16.0878}, {5.0, 5.4202}, {20.0, 1.5232}})
    EXPECT_NEAR(highest_visible_frequency(speed), cutoff, 1e-3);
  EXPECT_NEAR(slow_speed(30), 1.41, 0.01);
  EXPECT_NEAR(slow_speed(60), 0.15, 1e-9);
}

}  // namespace
}  // namespace tempolux::vision
