// Mixtures whose best share is known on paper.
#include "lib/filter/choose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace tempolux {
namespace {

constexpr int kSide = 128;
constexpr std::size_t kCount = kSide * kSide;

Colours constant(float value) {
  Colours colours;
  for (auto& plane : colours) plane.assign(kCount, value);
  return colours;
}

/// Grey noise: all colours of a pixel are equal.
Colours noise(unsigned seed, float sigma) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(1, sigma);
  Colours colours = constant(0);
  for (std::size_t p = 0; p < kCount; ++p) colours[0][p] = colours[1][p] = colours[2][p] = normal(random);
  return colours;
}

const Neighbourhood kInside(std::vector<std::uint8_t>(kCount, 1), kSide, kSide);

PictureLight light_of(const Colours& picture) {
  const PicturePlanes planes{&picture[0], &picture[1], &picture[2]};
  return PictureLight(planes, kSide, kSide, dark_of(planes));
}

/// The mixture.
Colours chosen(const Halves& raw, const std::vector<Halves>& candidates) {
  Colours colours = raw.a;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < kCount; ++p) colours[c][p] = mean_of(raw.a[c][p], raw.b[c][p]);
  const Halves halves = choose(raw, candidates, kInside, light_of(colours));
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < kCount; ++p) colours[c][p] = mean_of(halves.a[c][p], halves.b[c][p]);
  return colours;
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += double(v);
  return sum / double(values.size());
}

double squared_error(const std::vector<float>& values, double truth) {
  double sum = 0;
  for (const float v : values) sum += (double(v) - truth) * (double(v) - truth);
  return sum / double(values.size());
}

TEST(Choose, WhereHalvesAgreeThePictureStays) {
  const Colours light = noise(1, 0.25f);
  const Colours out = chosen({light, light}, {{constant(1), constant(1)}});
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(out[c], light[c]);
}

/// V = sigma^2 / 2 is the variance of M. For a candidate without noise and with the bias b, the best share is V / (V +
/// b^2), here .5. The standard error of V - C from 108 pixels, 2 V / sqrt(108) = .19 V, is added: w = .6. The bias is
/// given back: the mean of M stays, to rounding. What remains is the noise (1 - w)^2 V = .16 V. (F - M)^2 is estimated
/// from as many pixels, so w has a random error of about .1, which adds .01 (V + b^2) = .02 V; the mean of M over about
/// 100 pixels adds .01 V. Without the light given back the squared error would be .16 V + .36 b^2. Seen to fail: no
/// light given back.
TEST(Choose, ABiasedCandidateGetsAShareAndLeavesTheMean) {
  const float sigma = 0.1f, variance = sigma * sigma / 2, b = std::sqrt(variance);
  const Halves raw{noise(2, sigma), noise(3, sigma)};
  const Colours out = chosen(raw, {{constant(1 + b), constant(1 + b)}});
  EXPECT_NEAR(mean(out[1]), (mean(raw.a[1]) + mean(raw.b[1])) / 2, 1e-6);
  EXPECT_NEAR(squared_error(out[1], 1), 0.16 * double(variance), 0.08 * double(variance));
}

/// A candidate with a bias of 10 standard deviations of M gets the share 1 / 101.
TEST(Choose, AWrongCandidateLeavesTheRawPicture) {
  const float sigma = 0.05f, b = 10 * sigma / std::sqrt(2.0f);
  const Colours out = chosen({noise(4, sigma), noise(5, sigma)}, {{constant(1 + b), constant(1 + b)}});
  EXPECT_LT(squared_error(out[0], 1), 1.03 * double(sigma) * double(sigma) / 2);
}

/// The right one of two candidates leaves almost none of the noise, in either order. Its own estimate of V has an error
/// of 18 %, and w is clamped to 1.
TEST(Choose, TheBetterCandidateIsTaken) {
  const float sigma = 0.1f;
  const Halves right{constant(1), constant(1)}, wrong{constant(1.5f), constant(1.5f)},
      raw{noise(6, sigma), noise(7, sigma)};
  for (const auto& candidates : {std::vector{right, wrong}, std::vector{wrong, right}})
    EXPECT_LT(squared_error(chosen(raw, candidates)[2], 1), 0.06 * double(sigma) * double(sigma) / 2);
}

/// f = (A + c) / 2 and g = (B + c) / 2 with c = 1 + b keep half of the raw noise. The covariance of F and M is V / 2,
/// and the mean of (F - M)^2 is (b^2 + V) / 4. With b^2 = 3 V the best share is (V - V / 2) / V = .5; with the standard
/// error of V - C, .19 V / 2, w = .6. The noise (1 - w / 2)^2 V = .49 V remains. Without the covariance the share would
/// be 1, and .25 V would remain. w has a random error of about .1, and so the squared error one of .07 V at a pixel.
/// Seen to fail: the noise of the candidate left out.
TEST(Choose, NoiseThatACandidateKeepsCountsAgainstIt) {
  const float sigma = 0.1f, b = sigma * std::sqrt(1.5f);
  const Halves raw{noise(8, sigma), noise(9, sigma)};
  Halves candidate = raw;
  for (Colours* half : {&candidate.a, &candidate.b})
    for (auto& plane : *half)
      for (float& v : plane) v = (v + 1 + b) / 2;
  const Colours out = chosen(raw, {candidate});
  EXPECT_NEAR(squared_error(out[0], 1) / (double(sigma) * double(sigma) / 2), 0.49, 0.06);
}

/// One pixel of 30 times the light in both halves, among pixels whose noise is .5 of the light. The mean of the 3 x 3
/// pixels around it is 1 + 29 / 9 = 4.2, so its level is 4.2 + .25 x 25.8 = 10.7 and its (F - M)^2 is 841 / 10.7^2
/// = 7.4, of which the window's middle counts 1 / 49: .15. V = .125 of the other pixels, of which eight count 1 / 4.2^2
/// each, is .1 in the mean. The share .1 / (.1 + .15) = .4 leaves (1 - .4)^2 = .36 of the noise; what the bright pixel
/// loses adds less than .2. Without the pixel's own light in its level its (F - M)^2 would be 48, the share .1, and .8
/// of the noise would remain.
TEST(Choose, ABrightPixelDoesNotKeepTheNoiseAroundIt) {
  const float sigma = 0.5f;
  Halves raw{noise(10, sigma), noise(11, sigma)};
  const std::size_t middle = kSide * kSide / 2 + kSide / 2;
  for (std::size_t c = 0; c < 3; ++c) raw.a[c][middle] = raw.b[c][middle] = 30;
  const Colours out = chosen(raw, {{constant(1), constant(1)}});
  double before = 0, after = 0;
  for (std::size_t y = 0; y < 5; ++y)
    for (std::size_t x = 0; x < 5; ++x)
      if (const std::size_t p = middle + (y - 2) * kSide + x - 2; p != middle) {
        before += std::pow(double(mean_of(raw.a[0][p], raw.b[0][p])) - 1, 2);
        after += std::pow(double(out[0][p]) - 1, 2);
      }
  EXPECT_LT(after, 0.75 * before);
}

/// A layer with a sharp step from .002 to 1. The light has no noise; noise of eight times the dark light lies in the
/// dark, where other layers add .05. The candidate is a ramp over the step, 7 pixels wide, which is .43 at the last
/// dark pixel. Dark pixels have V = .016^2 / 2 = 1.3e-4 and a level of about .07: V is .03 of its square. The ramp's (F
/// - M)^2 is up to .43^2 at the step, at a level of .4, and .29^2 beside it, at a level of .07: above 1 in the mean. So
/// w is about .01, and the last dark pixel gets .01 x .43 = .004 of light beside its own .002. If the mean of the layer
/// over 7 x 7 pixels were the level, dark pixels far from the step would decide for w, and the last dark pixel would
/// get .11.
TEST(Choose, AStepOfLightDoesNotGlowIntoTheDark) {
  const Colours first = noise(12, 8), second = noise(13, 8);
  Halves raw{constant(1), constant(1)}, ramp = raw;
  Colours picture = constant(1);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < kCount; ++p) {
      const float x = float(p % kSide) - kSide / 2;
      if (x < 0) raw.a[c][p] = 0.002f * first[c][p], raw.b[c][p] = 0.002f * second[c][p];
      ramp.a[c][p] = ramp.b[c][p] = std::clamp((x + 4) / 7, 0.001f, 1.0f);
      picture[c][p] = mean_of(raw.a[c][p], raw.b[c][p]) + 0.05f;
    }
  const Halves out = choose(raw, {ramp}, kInside, light_of(picture));
  double light = 0;
  for (std::size_t y = 0; y < kSide; ++y) light += double(out.a[1][y * kSide + kSide / 2 - 1]) / kSide;
  EXPECT_LT(light, 0.01);
}

TEST(Choose, ACandidateThatFiltersNothingChangesNothing) {
  const Halves raw{noise(8, 0.2f), noise(9, 0.2f)};
  const Colours out = chosen(raw, {raw});
  for (std::size_t p = 0; p < kCount; ++p) EXPECT_FLOAT_EQ(out[0][p], (raw.a[0][p] + raw.b[0][p]) / 2);
}

TEST(Choose, WhatIsNoNumberIsFilledAndDecidesNothing) {
  Halves raw{constant(1), constant(1)};
  const Halves candidate{constant(1), constant(1)};
  raw.a[0][100] = std::numeric_limits<float>::quiet_NaN();
  raw.b[1][5000] = std::numeric_limits<float>::infinity();
  raw.a[2][7000] = 1e30f;
  const Colours out = chosen(raw, {candidate});
  for (const auto& plane : out)
    for (std::size_t p = 0; p < kCount; ++p)
      if (p != 7000) { EXPECT_EQ(plane[p], 1.0f); }
  EXPECT_EQ(out[2][7000], 5e29f);
}

}  // namespace
}  // namespace tempolux
