// The error that a filtered frame reports against its true error.
#include "lib/filter/remaining_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/filter_frames.h"

namespace tempolux {
namespace {

using test::at;
using test::grey;
using test::wall;

constexpr int kWide = 160, kHigh = 128;

/// Waves of light, half of it in each of two layers. Halves LAYER + n and LAYER - n are uncorrelated if the layer's
/// noise and n are independent and have equal variance.
float truth(int x, int y, float length) { return 1 + 0.2f * std::sin(float(x + y) / length); }
Image waves(float length, float deviation) {
  Image frame = wall(kWide, kHigh);
  test::Noise noise(deviation / std::sqrt(2.0f));
  for (const char* layer : {"direct", "indirect"}) {
    grey(frame, layer, [&](int x, int y) { return truth(x, y, length) / 2 + noise(); });
    test::set_noise(frame, layer, [&](int, int) { return noise(); });
  }
  for (const char* c : {"R", "G", "B"}) {
    const auto part = [&](const char* layer, int x, int y) { return at(frame, std::string(layer) + "." + c, x, y); };
    test::plane(frame, c, [&](int x, int y) { return part("direct", x, y) + part("indirect", x, y); });
  }
  return frame;
}

double error_of(const Image& frame, float length) {
  double sum = 0;
  for (const char* c : {"R", "G", "B"})
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x) sum += std::pow(double(at(frame, c, x, y) - truth(x, y, length)), 2);
  return std::sqrt(sum / (3 * kWide * kHigh));
}

/// Short waves: the remaining error is blur, or most of the noise. The reported error is the square root of the mean of
/// (G - M)^2 - n^2 + 2 k n. With noise s of M alone, its terms vary by about 2 s^2 between pixels, so the mean of 20480
/// pixels in three colours has an error of .008 s^2; for a remaining error of .35 s this is 4 % of the root. Because
/// the candidate with the least estimate is taken, the result is a few per cent too small.
TEST(RemainingNoise, SaysTheErrorThatIsThere) {
  for (const float length : {3.0f, 1.2f}) {
    const Image out = test::filtered({waves(length, 0.1f)});
    const double said = out.numbers.at("tempolux:noise.linear"), is = error_of(out, length);
    EXPECT_NEAR(said, is, 0.15 * is) << length;
    EXPECT_LT(out.numbers.at("tempolux:noise.linear_error"), 0.1 * is) << length;
  }
}

/// Small errors in uniform light: the exposure brings it to .18, where a code is 255 x 1.055 / 2.4 x .18^(1 / 2.4 - 1)
/// of it.
TEST(RemainingNoise, CodesAreTheSlopeOfTheCurve) {
  Image frame = wall(8, 4);
  grey(frame, "", test::everywhere(3));
  RemainingError error;
  for (auto& plane : error.whole) plane.assign(frame.pixel_count(), 1e-4f);
  for (auto& plane : error.noise) plane.assign(frame.pixel_count(), 5e-5f);
  frame.numbers["tempolux:noise.direct.codes"] = 7;  // from the raw frame
  write_remaining_noise(error, frame);
  EXPECT_NEAR(frame.numbers.at("tempolux:noise.linear"), 0.01, 1e-7);
  EXPECT_NEAR(frame.numbers.at("tempolux:noise.exposure"), 0.06, 1e-6);
  const double slope = 255 * 1.055 / 2.4 * std::pow(0.18, 1 / 2.4 - 1);
  EXPECT_NEAR(frame.numbers.at("tempolux:noise.codes"), 0.01 * 0.06 * slope, 1e-5);
  EXPECT_FALSE(frame.numbers.contains("tempolux:noise.direct.codes"));
}

/// Almost all pixels are black, so the exposure is huge, and errors are far beyond white: they count as a viewer sees
/// them, 255 codes at most. The slope of the curve alone would say 10^5 codes.
TEST(RemainingNoise, AnErrorBeyondWhiteIsWhite) {
  Image frame = wall(8, 4);
  grey(frame, "", test::everywhere(1e-8f));
  RemainingError error;
  for (auto* colours : {&error.whole, &error.noise})
    for (auto& plane : *colours) plane.assign(frame.pixel_count(), 1e-4f);
  write_remaining_noise(error, frame);
  EXPECT_NEAR(frame.numbers.at("tempolux:noise.linear"), 0.01, 1e-6);
  const double code = 255 * (1.055 * std::pow(0.18, 1 / 2.4) - 0.055);  // the error: up to white, or down to black
  EXPECT_NEAR(frame.numbers.at("tempolux:noise.codes"), std::sqrt((code * code + (255 - code) * (255 - code)) / 2),
              0.1);
}

/// Long waves leave little but noise: the reported error is never below the difference of the filtered frame's halves.
TEST(RemainingNoise, NoiseAloneIsSaid) {
  const Image out = test::filtered({waves(20, 0.1f)});
  const double said = out.numbers.at("tempolux:noise.linear"), is = error_of(out, 20);
  EXPECT_GT(said, is / 1.3);
  EXPECT_LT(said, is * 1.3);
}

/// One pixel of 97 has light from one half of its samples that further samples have confirmed: 5 +- 5. The filter keeps
/// this light, and the account has its noise, 5 / sqrt(97) of the layer direct and of the picture. Halves that were set
/// to their mean would say the noise of the other pixels alone, .02.
TEST(RemainingNoise, ConfirmedLightStaysAndSaysItsNoise) {
  Image frame = waves(20, 0.1f);
  std::vector<float>& confirmed = frame.add("halves.confirmed").values;
  for (std::size_t p = 0; p < confirmed.size(); p += 97) {
    confirmed[p] = 4;
    for (const std::string c : {"R", "G", "B"}) {
      for (const std::string& channel : {c, "direct." + c}) frame.find(channel)->values[p] += 5;
      frame.find("direct.noise." + c)->values[p] = 5;
    }
  }
  const Image out = test::filtered({frame});
  EXPECT_GT(out.find("direct.R")->values[97], 0.8f * frame.find("direct.R")->values[97]);
  const double noise = 5 / std::sqrt(97.0);
  EXPECT_NEAR(out.numbers.at("tempolux:noise.direct.linear"), noise, 0.15 * noise);
  EXPECT_NEAR(out.numbers.at("tempolux:noise.linear"), noise, 0.15 * noise);
  EXPECT_LT(out.numbers.at("tempolux:noise.indirect.linear"), 0.05);
}

/// One pixel of 32 holds all light, from one half: its halves are L + L and L - L. The samples of this pixel found what
/// they mostly miss, so the pixel errs by its whole light, .18 after the exposure: 118 codes. The slope of the curve or
/// the mean over both signs would say less.
TEST(RemainingNoise, ARareBrightSampleIsAllError) {
  Image frame = wall(8, 4);
  const auto spot = [](int x, int y) { return x == 3 && y == 2 ? 1.0f : 0.0f; };
  grey(frame, "", spot);
  grey(frame, "indirect", spot);
  test::set_noise(frame, "indirect", spot);
  RemainingError error;
  for (auto* colours : {&error.whole, &error.noise})
    for (auto& plane : *colours) plane.assign(frame.pixel_count(), 0.0f);
  for (auto& plane : error.noise) plane[2 * 8 + 3] = 1;
  const double code = 255 * (1.055 * std::pow(0.18, 1 / 2.4) - 0.055);
  write_remaining_noise(error, frame);
  for (const char* of : {"", "indirect."}) {
    const std::string name = std::string("tempolux:noise.") + of;
    EXPECT_NEAR(frame.numbers.at(name + "codes"), code / std::sqrt(32.0), 1e-3) << of;
    EXPECT_NEAR(frame.numbers.at(name + "linear"), 1 / std::sqrt(32.0), 1e-6) << of;
  }
}

/// Each layer reports its own noise, and LAYER.noise is half the difference of its filtered halves: its mean square is
/// the reported one.
TEST(RemainingNoise, LayersSayTheirNoise) {
  const Image out = test::filtered({waves(20, 0.1f)});
  for (const std::string layer : {"direct", "indirect"}) {
    double is = 0, halves = 0;
    for (const std::string c : {"R", "G", "B"})
      for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
          is += std::pow(double(at(out, layer + "." + c, x, y) - truth(x, y, 20) / 2), 2) / (3 * kWide * kHigh);
          halves += std::pow(double(at(out, layer + ".noise." + c, x, y)), 2) / (3 * kWide * kHigh);
        }
    const double said = out.numbers.at("tempolux:noise." + layer + ".linear");
    EXPECT_NEAR(said, std::sqrt(halves), 1e-6) << layer;
    EXPECT_GT(said, std::sqrt(is) / 1.3) << layer;
    EXPECT_LT(said, std::sqrt(is) * 1.3) << layer;
    EXPECT_GT(out.numbers.at("tempolux:noise." + layer + ".codes"), 0) << layer;
  }
}

TEST(RemainingNoise, WhatIsNotFilteredSaysNothing) {
  Image frame = wall(8, 4);
  grey(frame, "", test::everywhere(3));
  frame.numbers["tempolux:noise.codes"] = 7;
  write_remaining_noise({}, frame);
  EXPECT_TRUE(frame.numbers.empty());
}

}  // namespace
}  // namespace tempolux
