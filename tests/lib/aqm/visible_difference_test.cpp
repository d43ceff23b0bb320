// tests/lib/aqm/visible_difference_test.cpp -- the model's response to gratings whose threshold is known, and
// properties that hold for any pair of pictures.
#include "lib/aqm/visible_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "lib/aqm/animation_quality.h"
#include "lib/aqm/cortex_channels.h"
#include "tests/lib/aqm/synthetic.h"

namespace tempolux::vision {
namespace {

constexpr double kPixelsPerDegree = 30, kMean = 100;

/// 192 x 192 pixels: a plane of 100 cd/m2, and on it a grating of Michelson contrast `contrast`, `frequency`
/// c/px, at `degrees`.
DisplayedPair grating(double frequency, double degrees, double contrast, int size = 192) {
  DisplayedPair pair{size, size, std::vector<float>(std::size_t(size) * std::size_t(size), float(kMean)), {}, {}};
  pair.second = pair.first;
  const double angle = degrees * std::numbers::pi / 180;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double along = (x - size / 2) * std::cos(angle) + (y - size / 2) * std::sin(angle);
      pair.second[std::size_t(y * size + x)] =
          float(kMean * (1 + contrast * std::cos(2 * std::numbers::pi * frequency * along)));
    }
  return pair;
}

/// Detection at the crest in the middle, `speed` deg/s across the display.
double seen(const DisplayedPair& pair, double speed, Gaze gaze = Gaze::fixed) {
  const std::vector<float> speeds(pair.first.size(), float(speed));
  const Detection detection = detection_map(pair, speeds, {kPixelsPerDegree, gaze});
  return detection.probability[std::size_t(pair.height / 2 * pair.width + pair.width / 2)];
}

/// The contrast at which a grating is seen with probability 1/2, times its sensitivity: 1 if the model is right. On a
/// plane the sum over channels grows as contrast^3.5, so P at the contrast 1/S determines the threshold.
double threshold_times_sensitivity(double frequency, double degrees, double speed) {
  const double sensitivity = contrast_sensitivity(frequency * kPixelsPerDegree, std::max(speed, kDriftSpeed));
  const double p = seen(grating(frequency, degrees, 1 / sensitivity), speed);
  return kHalfSeen / std::pow(-std::log1p(-p), 1 / kPsychometricSlope);
}

// Two estimates with equal errors: each error is d / sqrt(2), where d is their difference. The model compares m + a
// and m - a as m + a / sqrt(2) and m - a / sqrt(2). Grey is darker than the display's white, so nothing is clipped;
// mixtures are rounded in float32.
TEST(VisibleDifferenceTest, OfTwoEstimatesIsJudgedWhatEitherErrsBy) {
  const auto image = [](double amplitude) {
    return synthetic::rgb_image(
        96, 96, [=](std::size_t i, std::uint32_t) { return 0.4 + amplitude * std::sin(0.6 * double(i % 96)); });
  };
  const auto seen = [&](double first, double second, bool either) {
    const Image a = image(first), b = image(second);
    VisionOptions options{display_named("office")};
    options.of_either = either;
    return judge_frame(synthetic::compare(a, b), nullptr, options, "a").probability[48 * 96 + 48];
  };
  const double amplitude = 0.0015;
  const float expected = seen(amplitude / std::numbers::sqrt2, -amplitude / std::numbers::sqrt2, false);
  ASSERT_GT(expected, 0.05f);
  ASSERT_LT(expected, 0.9f);
  EXPECT_NEAR(seen(amplitude, -amplitude, true), expected, 1e-3);
  EXPECT_GT(seen(amplitude, -amplitude, false), expected);
}

// Required: a grating of contrast 1/S at a band's centre is seen with probability 1/2 at its crests, to within 15 %
// of contrast. 192 pixels hold whole periods of each grating at 0 degrees. The response to contrasts up to 1/3 is
// bent by (m^2 / 8) (1 - p) (2 - p) = 1.8 %, and the plane masks nothing. The rest is the effect of reflection at the
// border on the lowest band.
TEST(VisibleDifferenceTest, GratingsAtBandCentresAreSeenAtTheirThreshold) {
  for (const int band : {2, 3, 4, 5})
    for (const double degrees : {0.0, 30.0})
      for (const double speed : {0.0, 0.5, 1.0, 2.0, 5.0}) {
        const double frequency = band_frequency(band);
        if (contrast_sensitivity(frequency * kPixelsPerDegree, std::max(speed, kDriftSpeed)) < 3) continue;
        const double threshold = threshold_times_sensitivity(frequency, degrees, speed);
        EXPECT_NEAR(threshold, 1, 0.15) << frequency << " c/px, " << degrees << " degrees, " << speed << " deg/s";
        std::printf("%.4f c/px %2.0f deg %4.2f deg/s: contrast x S %.3f\n", frequency, degrees, speed, threshold);
      }
}

// Between bands and between orientations a grating excites several channels in part. Half of it in each of two
// channels gives (2 / 2^3.5)^(1/3.5) = .61 of the response of one channel; between both bands and orientations, .37.
// So the threshold is up to 1 / .37 = 2.7 times too high there. It is never below 1: the parts of one grating never
// sum to more than the whole.
TEST(VisibleDifferenceTest, GratingsBetweenBandsAreSeenAtMostThreeTimesLater) {
  for (const double frequency : {0.25, 0.125, 0.0625})
    for (const double degrees : {0.0, 15.0}) {
      const double threshold = threshold_times_sensitivity(frequency, degrees, 0);
      std::printf("%.4f c/px %2.0f deg still: contrast x S %.3f\n", frequency, degrees, threshold);
      EXPECT_GT(threshold, 0.85);
      EXPECT_LT(threshold, 2.8);
    }
}

TEST(VisibleDifferenceTest, WhatMovesTooFastIsNotSeen) {
  for (const auto& [band, speed] : {std::pair{2, 10.0}, {3, 20.0}, {4, 30.0}, {5, 80.0}}) {
    ASSERT_LT(contrast_sensitivity(band_frequency(band) * kPixelsPerDegree, speed), 1);
    EXPECT_LT(seen(grating(band_frequency(band), 0, 0.99), speed), 0.01) << band;
  }
}

DisplayedPair noisy_pair(int width, int height, double amplitude) {
  DisplayedPair pair{width, height, {}, {}, {}};
  for (std::size_t i = 0; i < std::size_t(width) * std::size_t(height); ++i) {
    pair.first.push_back(float(60 + 20 * synthetic::noise(1, i, 0)));
    pair.second.push_back(pair.first.back() + float(amplitude * synthetic::noise(2, i, 0)));
  }
  return pair;
}

double share_seen(const Detection& detection) {
  double count = 0;
  for (const float p : detection.probability) count += p > kSeenProbability;
  return count / double(detection.probability.size());
}

TEST(VisibleDifferenceTest, EqualPicturesDoNotDiffer) {
  const DisplayedPair pair = noisy_pair(70, 50, 0);
  for (const float p : detection_map(pair, {}, {30, Gaze::track}).probability) ASSERT_EQ(p, 0);
}

TEST(VisibleDifferenceTest, TheOrderOfTheTwoDoesNotMatter) {
  const DisplayedPair pair = noisy_pair(70, 50, 3);
  const DisplayedPair swapped{pair.width, pair.height, pair.second, pair.first, {}};
  const Detection one = detection_map(pair, {}, {30, Gaze::track}),
                  other = detection_map(swapped, {}, {30, Gaze::track});
  EXPECT_GT(share_seen(one), 0.01);
  EXPECT_LT(share_seen(one), 0.99);
  EXPECT_EQ(one.probability, other.probability);
}

// On a plane nothing is masked: every term rises with contrast. The mean response moves with it, by 1e-3 at
// most: hence steps of 1.2.
TEST(VisibleDifferenceTest, MoreContrastIsNeverSeenLess) {
  double before = 0;
  for (double contrast = 0.002; contrast < 0.9; contrast *= 1.2) {
    const double now = seen(grating(1.0 / 12, 0, contrast), 0);
    EXPECT_GE(now, before) << contrast;
    before = now;
  }
  EXPECT_GT(before, 0.999);
}

/// Patterns from -1 to 1, by column and row of a picture of kSize x kSize pixels.
constexpr int kSize = 64;
struct Pattern {
  const char* name;
  std::function<double(int, int)> at;
};
std::vector<Pattern> patterns() {
  const auto noise = [](std::uint64_t seed) {
    return [seed](int x, int y) { return synthetic::noise(seed, std::size_t(y * kSize + x), 0) / std::sqrt(3.0); };
  };
  return {{"plane", [](int, int) { return 0.0; }},
          {"noise", noise(1)},
          {"edge", [](int x, int) { return x < 40 ? -1.0 : 1.0; }},
          {"checks", [](int x, int y) { return (x / 8 + y / 8) % 2 ? -1.0 : 1.0; }},
          {"blotch", [](int x, int y) { return std::exp(-(std::pow(x - 48, 2) + std::pow(y - 40, 2)) / 288); }},
          {"other noise", noise(2)},
          {"grating", [](int x, int) { return std::cos(2 * std::numbers::pi * x / 12); }},
          {"dot", [](int x, int y) { return x == 60 && y == 33 ? 1.0 : 0.0; }}};
}

/// The largest fall of AQM, as a share, while the error of a picture is multiplied by 2 again and again.
double largest_fall(const Pattern& picture, double contrast, const Pattern& error, double& most) {
  double fall = 0;
  most = 0;
  for (double k = 0.001; k < 0.6; k *= 2) {
    DisplayedPair pair{kSize, kSize, {}, {}, {}};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double value = 1 + contrast * picture.at(x, y);
        pair.first.push_back(float(60 * value));
        pair.second.push_back(float(60 * (value + k * error.at(x, y))));
      }
    const double share = share_seen(detection_map(pair, {}, {37.8, Gaze::track}));
    fall = std::max(fall, most - share);
    most = std::max(most, share);
  }
  return fall;
}

// An error of any form on any picture: AQM never falls as the error grows. A picture's own negative is an error of
// another kind (docs/methods/vision.md, limits).
TEST(VisibleDifferenceTest, AqmNeverFallsAsAnErrorGrows) {
  const std::vector<Pattern> all = patterns();
  for (std::size_t picture = 0; picture < 5; ++picture)
    for (std::size_t error = 1; error < all.size(); ++error)
      for (const double contrast : {0.05, 0.3}) {
        double most = 0;
        const double fall = largest_fall(all[picture], contrast, all[error], most);
        EXPECT_LE(fall, 0.001) << all[picture].name << " of " << contrast << ", error: " << all[error].name;
        const bool dot = error == all.size() - 1;  // of contrast .5; not seen on every picture
        EXPECT_TRUE(dot || most > 0.001) << all[picture].name << ", error: " << all[error].name;
      }
}

// A picture that is brighter everywhere by a constant factor: frequency 0, which no eye sees by itself.
TEST(VisibleDifferenceTest, AUniformChangeIsNotSeen) {
  DisplayedPair pair = grating(1.0 / 12, 0, 0, 64);
  for (float& value : pair.second) value *= 1.2f;
  for (const float p : detection_map(pair, {}, {30, Gaze::track}).probability) EXPECT_LT(p, 1e-3);
}

// Masked pixels count as equal, whatever they hold, and do not affect their neighbours. The neighbours differ by .01
// cd/m2, which nobody sees, so that none of them is skipped as equal.
TEST(VisibleDifferenceTest, WhatDoesNotCountIsNotSeen) {
  DisplayedPair pair = grating(1.0 / 12, 0, 0, 64);
  for (float& value : pair.second) value += 0.01f;
  pair.counted.assign(pair.first.size(), 1);
  for (std::size_t i = 20 * 64; i < 30 * 64; ++i) pair.second[i] = 0, pair.counted[i] = 0;
  for (const float p : detection_map(pair, {}, {30, Gaze::track}).probability) EXPECT_LT(p, 1e-3);
}

TEST(VisibleDifferenceTest, SinglePixelsAndNarrowPicturesHaveAnAnswer) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {300, 1}, {3, 2}}) {
    DisplayedPair pair = noisy_pair(width, height, 30);
    for (const float p : detection_map(pair, {}, {30, Gaze::track}).probability) EXPECT_TRUE(p >= 0 && p <= 1);
  }
}

// The local amplitude does not depend on the phase, and bands 1 and 2, which respond most to a dot, are sampled at
// every pixel. The remaining difference, 1.2 %, comes from band 3, which is sampled at every second pixel. With bands
// 1 and 2 at every second pixel it was 19 %.
TEST(VisibleDifferenceTest, ADotIsSeenAlikeWhereverItLies) {
  double least = 1e9, most = 0;
  for (const auto& [x, y] : {std::pair{32, 32}, {33, 32}, {32, 33}, {33, 33}}) {
    double low = 0, high = 2;
    for (int i = 0; i < 14; ++i) {  // the contrast at which the dot itself is seen with probability 1/2
      const double middle = 0.5 * (low + high);
      DisplayedPair pair = grating(0.1, 0, 0, 64);
      pair.second[std::size_t(y * 64 + x)] = float(kMean * (1 + middle));
      const double p = detection_map(pair, {}, {30, Gaze::track}).probability[std::size_t(y * 64 + x)];
      (p < 0.5 ? low : high) = middle;
    }
    std::printf("dot at %d, %d: contrast %.4f\n", x, y, low);
    least = std::min(least, low), most = std::max(most, low);
  }
  EXPECT_LT(most, 1.02 * least);
}

}  // namespace
}  // namespace tempolux::vision
