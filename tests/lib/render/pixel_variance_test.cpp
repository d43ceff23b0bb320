// The variance that a frame reports of its pixels: for independent samples, for stratified ones, for one sample.
#include "lib/render/pixel_variance.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

Layers grey_light(float direct, float emission = 0) {
  Layers layers;
  layers[Layer::direct] = Rgb(direct);
  layers[Layer::emission] = Rgb(emission);
  return layers;
}

/// The mean of n samples of variance 1 has the variance 1/n, for odd n, too. 20 000 pixels; an estimate with one degree
/// of freedom scatters by sqrt(2) of its value: 4 sigma of the mean are 4 %.
TEST(PixelVariance, IsThatOfTheMeanOfIndependentSamples) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(5, 1);
  for (const int n : {2, 3, 8, 9}) {
    double sum = 0;
    constexpr int kPixels = 20'000;
    for (int p = 0; p < kPixels; ++p) {
      SampleHalves halves;
      for (int s = 0; s < n; ++s) halves.add(2 * s >= n, {grey_light(normal(random)), {}, {}}, {});
      EXPECT_EQ(halves.samples(), float(n));
      sum += double(halves.variance(kDiffuseLayers).g);
    }
    EXPECT_NEAR(sum / kPixels * n, 1, 0.04) << n;
  }
}

TEST(PixelVariance, OneSampleKnowsNone) {
  SampleHalves halves;
  halves.add(0, {grey_light(3), {}, {}}, {});
  EXPECT_EQ(halves.variance(kImageLayers), Rgb(0.0f));
  EXPECT_EQ(halves.samples(), 1.0f);
}

TEST(PixelVariance, EmissionCountsInTheImageAndNotInDiffuseLight) {
  SampleHalves halves;
  halves.add(0, {grey_light(1, 0), {}, {}}, {});
  halves.add(1, {grey_light(1, 4), {}, {}}, {});
  EXPECT_EQ(halves.variance(kDiffuseLayers), Rgb(0.0f));
  EXPECT_EQ(halves.variance(kImageLayers), Rgb(4.0f));  // (1 - 5)^2 / 4
}

/// Each part is divided by its own number of samples: for 6 camera rays, 12 samples of light of variance 1 and 3 rays
/// onward of variance 4 the mean has the variance 1/12 + 4/3. 20 000 pixels as above.
TEST(PixelVariance, PartsAreDividedByTheirOwnNumbers) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal(0, 1);
  double sum = 0;
  constexpr int kPixels = 20'000;
  for (int p = 0; p < kPixels; ++p) {
    SampleHalves halves;
    for (int s = 0; s < 6; ++s) {
      const std::uint32_t onward = s % 2;
      halves.add(s >= 3,
                 {grey_light(1), grey_light(6 + normal(random) + normal(random)),
                  grey_light(onward ? 9 + 2 * normal(random) : 0)},
                 {2, onward, 0, 0});
    }
    EXPECT_EQ(halves.samples(), 6);
    sum += double(halves.variance(kDiffuseLayers).g);
  }
  // Of 3 rays onward one half has one and the other two: the estimate is (n_a n_b)^(1/2) / n of the difference, 4/3 in
  // the mean.
  EXPECT_NEAR(sum / kPixels, 1.0 / 12 + 4.0 / 3, 0.04 * (1.0 / 12 + 4.0 / 3));
}

/// The variance of a frame with eight samples per pixel, summed over pixels, against that between 24 seeds. Halves of
/// stratified samples are less well stratified than the whole: where the error's variance falls as n^-2, as at straight
/// edges, the estimate is twice too large. 24 seeds measure it within a fifth. (If samples of even and odd number
/// formed the halves, each in one half of the pixel, the estimate would be nine times too large.)
TEST(PixelVariance, KnowsStratification) {
  const test::Cornell c;
  const test::NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 8;
  options.sample_halves = true;
  constexpr int kSeeds = 24;
  const std::size_t pixels = 64 * 36;
  std::vector<double> sum(pixels), square(pixels);
  double told = 0, spread = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = std::uint64_t(seed) + 1;
    const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
    for (std::size_t p = 0; p < pixels; ++p) {
      const double value = double(frame.mean.pixels[p][Layer::direct].g);
      sum[p] += value;
      square[p] += value * value;
      told += double(frame.mean.sample_halves[p].variance(kDiffuseLayers).g) / kSeeds;
    }
  }
  for (std::size_t p = 0; p < pixels; ++p) spread += (square[p] - sum[p] * sum[p] / kSeeds) / (kSeeds - 1);
  EXPECT_GT(told / spread, 0.9);
  EXPECT_LT(told / spread, 2.4);
}

/// All passes that trace samples keep halves: 16 samples plainly, in two halves of a frame, and adaptively.
TEST(PixelVariance, EverySampleIsCounted) {
  const test::Cornell c;
  const test::NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 4;
  options.sample_halves = true;
  const auto mean_samples = [&](const LayerImage& image) {
    double sum = 0;
    for (const SampleHalves& halves : image.sample_halves) sum += double(halves.samples());
    return sum / double(image.pixels.size());
  };
  EXPECT_EQ(mean_samples(render_frame(c.render_scene(), c.view, options).mean), 4);
  options.pixel_error = 0.02;
  const RenderedFrame adaptive = render_frame(c.render_scene(), c.view, options);
  EXPECT_GT(adaptive.samples_per_pixel, 4);
  EXPECT_NEAR(mean_samples(adaptive.mean), adaptive.samples_per_pixel, 1e-6);
  options.pixel_error = 0;
  options.halves = true;
  const RenderedFrame halves = render_frame(c.render_scene(), c.view, options);
  EXPECT_EQ(mean_samples(halves.mean), 4);
  EXPECT_EQ(mean_samples(halves.half[1]), 2);
}

/// The channels' halves m + n and m - n are uncorrelated: the covariance of their errors over 48 seeds, averaged over
/// pixels, is 0 compared with their variance v. Each pixel's estimate of the covariance scatters by v / sqrt(47). Over
/// n pixels like these, of which few carry most (the sum of v^2 over the square of the sum of v, here 1 / 150), the
/// mean scatters by v / sqrt(47 x 150) = .012 v. The share of a frame comes from its 84 pixels that are rendered twice,
/// of which some 20 carry weight: an error of sqrt(3 / 20) = .4 of itself, over the seeds .06. The band is .15.
/// (Without the share the covariance is -.42 v.)
TEST(PixelVariance, ChannelHalvesAreUncorrelated) {
  const test::Cornell c;
  const test::NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 4;
  options.sample_halves = true;
  constexpr int kSeeds = 48;
  constexpr auto kDirect = std::size_t(Layer::direct);
  for (const double pixel_error : {0.0, 0.02}) {
    options.pixel_error = pixel_error;
    const std::size_t pixels = 64 * 36;
    std::vector<double> a(pixels), b(pixels), ab(pixels), aa(pixels), bb(pixels);
    for (int seed = 0; seed < kSeeds; ++seed) {
      options.seed = std::uint64_t(seed) + 1;
      const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
      const double share = std::sqrt(frame.mean.difference_share[kDirect]);
      for (std::size_t p = 0; p < pixels; ++p) {
        const SampleHalves& halves = frame.mean.sample_halves[p];
        const double m = double(frame.mean.pixels[p][Layer::direct].g),
                     n = share * double(halves.difference(kDirect).g), x = m + n, y = m - n;
        EXPECT_NEAR(m, double(halves.mean(kDirect).g), 1e-5 * m);
        a[p] += x, b[p] += y, ab[p] += x * y, aa[p] += x * x, bb[p] += y * y;
      }
    }
    double covariance = 0, variance = 0;
    for (std::size_t p = 0; p < pixels; ++p) {
      covariance += ab[p] - a[p] * b[p] / kSeeds;
      variance += (aa[p] - a[p] * a[p] / kSeeds + bb[p] - b[p] * b[p] / kSeeds) / 2;
    }
    EXPECT_GT(variance, 0);
    EXPECT_NEAR(covariance / variance, 0, 0.15) << pixel_error;
  }
}

/// Two samples, 1 and 5, in one half each: half their difference, -2, times the root of a share of a quarter. Light
/// taken from the pixel, .5 of 3, is taken from the difference as well: what is left of an outlier keeps its noise.
TEST(PixelVariance, NoiseIsAShareOfTheHalvesDifference) {
  LayerImage layers;
  layers.width = 2, layers.height = 1;
  layers.sample_halves.resize(2);
  for (SampleHalves& halves : layers.sample_halves) {
    halves.add(0, {grey_light(1), {}, {}}, {});
    halves.add(1, {grey_light(5), {}, {}}, {});
  }
  layers.pixels = {grey_light(3), grey_light(2.5f)};
  layers.difference_share.fill(0.25);
  Image image{2, 1, {}, {}, {}, {}};
  add_variance_channels(layers, {"halves"}, image);
  EXPECT_EQ(image.find("direct.noise.G")->values, (std::vector<float>{-1, -0.75f}));
  EXPECT_EQ(image.find("emission.noise.G")->values, (std::vector<float>{0, 0}));
  EXPECT_EQ(image.find("volume.noise.G"), nullptr);
  EXPECT_EQ(image.find("halves.confirmed")->values, (std::vector<float>{0, 0}));
  layers.confirmed = {0, 6};
  layers.stored_noise = {{Rgb(0.25f), Rgb(0.5f)}, {Rgb(0.0f), Rgb(-2.0f)}};
  Image with_records{2, 1, {}, {}, {}, {}};
  add_variance_channels(layers, {"halves"}, with_records);
  EXPECT_EQ(with_records.find("indirect.noise.G")->values, (std::vector<float>{0.5f, -2}));
  EXPECT_EQ(with_records.find("caustic.noise.G")->values, (std::vector<float>{0.25f, 0}));
  EXPECT_EQ(with_records.find("halves.confirmed")->values, (std::vector<float>{0, 6}));
  EXPECT_EQ(with_records.find("direct.noise.G")->values, (std::vector<float>{-1, -0.75f}));
}

}  // namespace
}  // namespace tempolux
