// tests/lib/aqm/frame_error_test.cpp -- error figures of frames whose error is known on paper.
#include "lib/aqm/frame_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/error.h"
#include "tests/lib/aqm/synthetic.h"

namespace tempolux {
namespace {

using namespace synthetic;

TEST(FrameErrorTest, EqualFramesHaveNoErrorAndNoPsnr) {
  const Image image = noisy_image(40, 30, 1, 0.5, 1);
  const FrameError error = errors_of(image, image);
  EXPECT_EQ(error.pixels, 1200u);
  EXPECT_EQ(error.squared_error.squared.value, 0);
  EXPECT_EQ(error.squared_error.root(), 0);
  EXPECT_EQ(error.bias->value, 0);
  EXPECT_EQ(error.relative_squared_error->value, 0);
  EXPECT_FALSE(error.psnr_db);
  EXPECT_EQ(error.largest.value, 0);
}

// x = r + 1/4 with r = 1/2, all exact in float: every figure is a fraction. relMSE: (1/16) / (1/4 + 1/400).
TEST(FrameErrorTest, ConstantOffsetGivesTheFractionsOnPaper) {
  const FrameError error = errors_of(constant_image(32, 16, 0.75), constant_image(32, 16, 0.5));
  EXPECT_DOUBLE_EQ(error.squared_error.squared.value, 1.0 / 16);
  EXPECT_DOUBLE_EQ(error.squared_error.root(), 0.25);
  EXPECT_NEAR(*error.squared_error.squared.standard_error, 0, 1e-15);
  EXPECT_TRUE(error.squared_error.resolved());
  EXPECT_DOUBLE_EQ(error.bias->value, 0.5);
  EXPECT_NEAR(error.relative_squared_error->value, (1.0 / 16) / (0.25 + 0.0025), 1e-14);
  EXPECT_NEAR(*error.psnr_db, 20 * std::log10(0.5 / 0.25), 1e-12);
  EXPECT_DOUBLE_EQ(error.mean_difference.value, 0.25);
  EXPECT_DOUBLE_EQ(error.mean_test, 0.75);
  EXPECT_DOUBLE_EQ(error.largest.value, 0.25);
}

TEST(FrameErrorTest, LargestDifferenceNamesItsPixelAndChannel) {
  Image test = constant_image(20, 10, 1);
  test.find("G")->values[7 * 20 + 13] = -2;
  const FrameError error = errors_of(test, constant_image(20, 10, 1));
  EXPECT_EQ(error.largest.value, -3);
  EXPECT_EQ(error.largest.x, 13);
  EXPECT_EQ(error.largest.y, 7);
  EXPECT_EQ(error.largest.channel, "G");
}

// relMSE scales out: brightness 1000 times that of another scene changes nothing (2000 is not a power of two,
// hence the tolerance of a few float roundings).
TEST(FrameErrorTest, RelativeErrorDoesNotDependOnBrightness) {
  const auto scaled = [](double s) {
    const Image r = rgb_image(16, 16, [=](std::size_t i, std::uint32_t) { return s * double(1 + i % 5); });
    const Image x = rgb_image(16, 16, [=](std::size_t i, std::uint32_t) { return s * (1.25 + double(i % 5)); });
    return errors_of(x, r).relative_squared_error->value;
  };
  EXPECT_NEAR(scaled(2000) / scaled(2), 1, 1e-5);
}

// x equals the truth r, and the halves of the reference have 60 % noise. The numerator is 0 in the mean but
// correlated with the denominator, so relMSE is above 0: by up to 2 s^4 (3 r^2 - e^2) / (r^2 + e^2)^3 with s^2 = 0.18
// and e = 0.1, plus higher terms. Here it is less, 0.015, because the denominator is a mean over channels. With the
// true r in the denominator it is 0 within 4 sigma = 4 x 0.36 / 1.01 / sqrt(3 x 65536) = 0.0033.
TEST(FrameErrorTest, ASmoothDenominatorTakesTheReferencesNoiseOutOfRelMse) {
  const Image x = constant_image(256, 256, 1), r1 = noisy_image(256, 256, 1, 0.6, 1),
              r2 = noisy_image(256, 256, 1, 0.6, 2);
  Compared pair = compare(x, r1, &r2);
  EXPECT_GT(figures_of(sum_errors(pair, 0), 64).relative_squared_error->value, 0.01);
  const LayerPlanes smooth = layer_planes({&x, "smooth.exr"}, "");
  pair.smooth = smooth.planes;
  EXPECT_NEAR(figures_of(sum_errors(pair, 0), 64).relative_squared_error->value, 0, 0.0033);
  // The smooth denominator is the only change: it is 2 instead of 1; x is off by 1/4 everywhere, and r has no noise.
  const Image r = constant_image(256, 256, 1), off = constant_image(256, 256, 1.25),
              twice = constant_image(256, 256, 2);
  const ComparedInputs inputs{{&off, "x"}, {&r, "r"}, {}, {}, "", {&twice, "s"}};
  const FrameError error = figures_of(sum_errors(compare_layers(inputs), 0), 64);
  EXPECT_NEAR(error.relative_squared_error->value, 0.0625 / (4 + 0.01), 1e-12);
  EXPECT_DOUBLE_EQ(error.bias->value, 0.25);
}

// x = r_true + 0.02 with halves r_true + 0.1 noise. The product (x-r1)(x-r2) has mean 0.0004 and standard
// deviation sqrt(0.01^2 + 2 0.0004 0.01) = 0.0104 per sample; 3 x 65536 samples give 2.3e-5: 4 sigma = 9.4e-5
// per image, over 16 seeds 2.3e-5. The plain squared error against one half would be 0.0104, against the mean
// of both 0.0054.
TEST(FrameErrorTest, HalvesGiveTheSquaredErrorWithoutTheReferencesNoise) {
  const Image x = constant_image(256, 256, 1.02);
  double sum = 0, chi = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const Image r1 = noisy_image(256, 256, 1, 0.1, 2 * seed), r2 = noisy_image(256, 256, 1, 0.1, 2 * seed + 1);
    const FrameError error = errors_of(x, r1, &r2);
    const Estimate squared = error.squared_error.squared;
    EXPECT_NEAR(squared.value, 0.0004, 9.4e-5);
    EXPECT_NEAR(*squared.standard_error, 0.0104 / std::sqrt(3.0 * 65536),
                0.25 * 2.35e-5);  // from 256 blocks: 4 / sqrt(2 x 256)
    EXPECT_TRUE(error.squared_error.resolved());
    EXPECT_NEAR(*error.reference_noise, 0.1 / std::sqrt(2.0), 0.001);
    sum += squared.value;
    chi += std::pow((squared.value - 0.0004) / *squared.standard_error, 2);
  }
  EXPECT_NEAR(sum / 16, 0.0004, 2.35e-5);
  EXPECT_LT(chi, 16 + 4 * std::sqrt(2.0 * 16));  // chi-square of 16: the standard errors are true ones
  EXPECT_GT(chi, 3.6);                           // its 0.1 % quantile
}

// With one reference its noise stays: 0.0004 + 0.01, sigma of a sample about 0.01: 4 sigma of 196608 is 1e-4.
TEST(FrameErrorTest, OneReferenceKeepsItsNoise) {
  const FrameError error = errors_of(constant_image(256, 256, 1.02), noisy_image(256, 256, 1, 0.1, 1));
  EXPECT_NEAR(error.squared_error.squared.value, 0.0104, 1e-4);
  EXPECT_FALSE(error.halves);
  EXPECT_FALSE(error.reference_noise);
}

// A perfect frame against noisy halves: about half of all seeds give a negative estimate, none is resolved, and the
// root is 0 or within noise. P(fewer than 3 or more than 21 of 24 negative) < 4e-5.
TEST(FrameErrorTest, BelowTheReferencesNoiseTheRootIsZeroAndUnresolved) {
  int negative = 0, resolved = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const Image r1 = noisy_image(64, 64, 1, 0.1, 2 * seed), r2 = noisy_image(64, 64, 1, 0.1, 2 * seed + 1);
    const SquaredFigure figure = errors_of(constant_image(64, 64, 1), r1, &r2).squared_error;
    resolved += figure.resolved();
    if (figure.squared.value >= 0) continue;
    ++negative;
    EXPECT_EQ(figure.root(), 0);
    EXPECT_FALSE(figure.root_standard_error());
  }
  EXPECT_GE(negative, 3);
  EXPECT_LE(negative, 21);
  EXPECT_LE(resolved, 1);
}

// Noise that is equal within squares of 4x4 pixels: there are 16 times fewer independent samples than pixels. The
// reported standard error must equal the scatter of the image mean over seeds. A standard error per pixel would be 4
// times too small.
TEST(FrameErrorTest, StandardErrorAllowsForNeighboursThatErrTogether) {
  double scatter = 0, claimed = 0;
  constexpr int kSeeds = 64;
  const Image r = constant_image(128, 128, 1);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Image x = rgb_image(128, 128, [=](std::size_t i, std::uint32_t) {
      return 1 + 0.1 * noise(seed, (i / 128 / 4) * 32 + i % 128 / 4, 0);
    });
    const Estimate bias = *errors_of(x, r).bias;
    scatter += bias.value * bias.value;
    claimed += *bias.standard_error * *bias.standard_error;
  }
  EXPECT_NEAR(std::sqrt(scatter / claimed), 1, 4 / std::sqrt(2.0 * kSeeds));
  EXPECT_NEAR(std::sqrt(claimed / kSeeds), 0.1 / 32, 0.1 * 0.1 / 32);
}

// Half of the image is 3 % too bright and half 3 % too dark, with equal radiance: the image has no bias, but its two
// objects have one.
TEST(FrameErrorTest, BiasOfAnObjectHidesInTheWholeImage) {
  Image x = rgb_image(64, 64, [](std::size_t i, std::uint32_t) { return i % 64 < 32 ? 1.03 : 0.97; });
  Channel& ids = x.add_ids("id.object");
  for (std::size_t i = 0; i < ids.ids.size(); ++i) ids.ids[i] = i % 64 < 32 ? 5 : 9;
  ids.ids[0] = 7;
  const FrameError error = errors_of(x, constant_image(64, 64, 1));
  EXPECT_NEAR(error.bias->value, 0, 1e-7);
  ASSERT_EQ(error.objects.size(), 3u);
  EXPECT_EQ(error.objects[0].id, 5u);
  EXPECT_EQ(error.objects[0].pixels, 2047u);
  EXPECT_NEAR(error.objects[0].bias->value, 0.03, 1e-6);
  EXPECT_NEAR(*error.objects[0].bias->standard_error, 0, 1e-6);
  EXPECT_FALSE(error.objects[0].few_pixels);
  EXPECT_TRUE(error.objects[1].few_pixels);             // id 7, one pixel
  EXPECT_FALSE(error.objects[1].bias->standard_error);  // one block: no scatter to judge by
  EXPECT_NEAR(error.objects[2].bias->value, -0.03, 1e-6);
  EXPECT_NEAR(error.objects[2].share_of_squared_error, 0.5, 1e-4);
}

TEST(FrameErrorTest, ObjectIdsMayComeFromTheReference) {
  Image r = constant_image(8, 8, 1);
  r.add_ids("id.object").ids.assign(64, 3);
  const FrameError error = errors_of(constant_image(8, 8, 2), r);
  ASSERT_EQ(error.objects.size(), 1u);
  EXPECT_EQ(error.objects[0].id, 3u);
}

TEST(FrameErrorTest, BlackReferenceHasNoBiasAndNoRelativeErrorButAnError) {
  const FrameError error = errors_of(constant_image(16, 16, 0.5), constant_image(16, 16, 0));
  EXPECT_FALSE(error.bias);
  EXPECT_FALSE(error.relative_squared_error);
  EXPECT_FALSE(error.psnr_db);
  EXPECT_DOUBLE_EQ(error.squared_error.root(), 0.5);
}

TEST(FrameErrorTest, OnePixelHasFiguresButNoStandardError) {
  const FrameError error = errors_of(constant_image(1, 1, 3), constant_image(1, 1, 1));
  EXPECT_DOUBLE_EQ(error.squared_error.squared.value, 4);
  EXPECT_FALSE(error.squared_error.squared.standard_error);
  EXPECT_FALSE(error.squared_error.resolved());
}

TEST(FrameErrorTest, PixelsOutsideTheMaskDoNotCountWhateverTheyHold) {
  Image x = constant_image(16, 16, 1.5);
  for (std::size_t i = 0; i < 128; ++i) x.find("R")->values[i] = NAN;
  Image mask;
  mask.width = mask.height = 16;
  Channel& channel = mask.add("mask");
  for (std::size_t i = 128; i < 256; ++i) channel.values[i] = 1;
  const FrameError error = errors_of(x, constant_image(16, 16, 1), nullptr, &mask);
  EXPECT_EQ(error.pixels, 128u);
  EXPECT_DOUBLE_EQ(error.squared_error.root(), 0.5);
  EXPECT_THROW(errors_of(x, constant_image(16, 16, 1)), InputError);
}

TEST(FrameErrorTest, FramesOfASequenceAddUpToItsMeans) {
  const Image r = constant_image(32, 32, 1);
  ErrorSums total = sum_errors(compare(constant_image(32, 32, 1.5), r), 0);
  Image second = constant_image(32, 32, 1);
  second.find("B")->values[40] = 4;
  add_errors(total, sum_errors(compare(second, r), 7));
  const FrameError error = figures_of(total, 64);
  EXPECT_EQ(error.pixels, 2048u);
  EXPECT_NEAR(error.squared_error.squared.value, (0.25 + 9.0 / 3072) / 2, 1e-14);
  EXPECT_EQ(error.largest.frame, 7);
  EXPECT_EQ(error.largest.value, 3);
}

// The mean of two halves of variance s^2 has variance s^2/2. 4 sigma of 3 x 16384 squares: 4 sqrt(0.8 /
// 49152) / 2 of the figure (the difference of two uniforms has kurtosis 2.4; 1.4 rounds that up).
TEST(FrameErrorTest, NoiseOfAnImageFollowsFromItsTwoHalves) {
  const Image a = noisy_image(128, 128, 1, 0.2, 1), b = noisy_image(128, 128, 1, 0.2, 2);
  const SquaredFigure noise_figure = noise_of_mean(errors_of(a, b));
  EXPECT_NEAR(noise_figure.root(), 0.2 / std::sqrt(2.0), 0.2 / std::sqrt(2.0) * 2 * std::sqrt(1.4 / 49152));
}

TEST(FlickerTest, ConstantErrorDoesNotFlickerAndAlternatingErrorDoesBySteps) {
  const Image bright = constant_image(32, 32, 1.5), dark = constant_image(32, 32, 0.75), r = constant_image(32, 32, 1);
  FlickerMeter steady, alternating;
  EXPECT_FALSE(steady.result());
  for (int t = 0; t < 4; ++t) {
    steady.add(compare(bright, r));
    alternating.add(compare(t % 2 ? bright : dark, r));
  }
  EXPECT_EQ(steady.result()->squared.value, 0);
  EXPECT_DOUBLE_EQ(alternating.result()->root(), 0.75);
}

TEST(FlickerTest, ChangeThatTheReferenceMakesTooIsNoFlicker) {
  FlickerMeter meter;
  for (const double level : {1.0, 2.0, 0.5})
    meter.add(compare(constant_image(8, 8, level + 0.25), constant_image(8, 8, level)));
  EXPECT_EQ(meter.result()->squared.value, 0);
}

// Errors drawn afresh per frame with sigma 0.05 flicker by 0.05 sqrt(2), squared 0.005, whatever the noise
// 0.1 of the references; without halves the squared flicker would be 0.005 + 0.02. A product has sigma below
// 0.025 x 1.2; 3 x 16384 x 7 of them, neighbours in time correlated (factor 2): 4 sigma < 3e-4.
TEST(FlickerTest, HalvesTakeTheReferencesNoiseOut) {
  FlickerMeter meter, plain;
  for (std::uint64_t t = 0; t < 8; ++t) {
    const Image x = noisy_image(128, 128, 1, 0.05, 100 + t);
    const Image r1 = noisy_image(128, 128, 1, 0.1, 200 + t), r2 = noisy_image(128, 128, 1, 0.1, 300 + t);
    meter.add(compare(x, r1, &r2));
    plain.add(compare(x, r1));
  }
  EXPECT_NEAR(meter.result()->squared.value, 0.005, 3e-4);
  EXPECT_TRUE(meter.result()->resolved());
  EXPECT_NEAR(plain.result()->squared.value, 0.025, 1e-3);
}

}  // namespace
}  // namespace tempolux
