// Samples of pixels by the noise of their neighbours: where they go, how many, and that they cause no bias.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

using test::Cornell;
using test::from_above;
using test::HandMadeScene;
using test::Lit;
using test::NoLight;

struct Mean {
  double sum = 0, square = 0;
  int count = 0;
  void add(double x) { sum += x, square += x * x, ++count; }
  double mean() const { return sum / count; }
  double sigma() const { return std::sqrt(std::max(0.0, square - sum * mean()) / (count - 1) / count); }
};

/// Further samples go where neighbours are noisy; a pixel's own samples must not decide. Direct light of the pixels
/// with the largest deviation between 80 seeds (penumbrae and edges), with one or two first samples each, against 1024
/// samples everywhere: 4 sigma of the mean of their errors. (If a pixel's own two samples decided, the mean would be
/// 0.8 % too dark, six sigma.)
TEST(AdaptiveFrame, SamplesWhereTheyAreNeededBringNoBias) {
  const Cornell c;
  const NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 1024;
  const RenderedFrame reference = render_frame(c.render_scene(), c.view, options);
  options.pixel_error = 0.02;
  constexpr int kSeeds = 80;
  const std::size_t pixels = reference.mean.pixels.size();
  for (const int first : {1, 2}) {
    options.samples = first;
    std::vector<double> sum(pixels), sum2(pixels);
    for (int seed = 0; seed < kSeeds; ++seed) {
      options.seed = std::uint64_t(seed) + 1;
      const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
      EXPECT_GT(frame.samples_per_pixel, 1.5 * first);
      for (std::size_t p = 0; p < pixels; ++p) {
        const double value = double(frame.mean.pixels[p][Layer::direct].g);
        sum[p] += value;
        sum2[p] += value * value;
      }
    }
    double error = 0, variance = 0, total_light = 0;
    int chosen = 0;
    for (std::size_t p = 0; p < pixels; ++p) {
      const double mean = sum[p] / kSeeds, var = std::max(0.0, sum2[p] / kSeeds - mean * mean) / (kSeeds - 1);
      const double expected = double(reference.mean.pixels[p][Layer::direct].g);
      if (!(std::sqrt(var * kSeeds) > 0.05 * expected) || !(expected > 0)) continue;
      ++chosen;
      error += mean - expected;
      variance += var;
      total_light += expected;
    }
    EXPECT_GT(chosen, 100) << first;
    EXPECT_NEAR(error / total_light, 0, 4 * std::sqrt(variance) / total_light + 0.0005) << first;
    EXPECT_LT(4 * std::sqrt(variance) / total_light, 0.006) << first;
  }
}

/// One first sample is enough to ask for more. With a limit that no pixel reaches, n ~ error^(-7/8), so half the error
/// needs 2^(7/8) = 1.83 times as many samples. Rounding down removes half a sample of some tens, and pixels that see
/// only black stay at one: 5 %. Not only edges get samples: the lamp is wide, and light on the walls varies by its
/// cosines alone.
TEST(AdaptiveFrame, OneFirstSampleIsEnoughToRefine) {
  const Cornell c;
  const NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 1;
  options.adaptive_limit = 1 << 20;
  options.sample_halves = true;
  int refined = 0;
  const auto samples = [&](double error) {
    options.pixel_error = error;
    const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
    refined = 0;
    for (const SampleHalves& halves : frame.mean.sample_halves) refined += halves.samples() > 4;
    return frame.samples_per_pixel;
  };
  const double some = samples(0.004), more = samples(0.002);
  EXPECT_GT(some, 10);
  EXPECT_GT(refined, 64 * 36 / 2);
  EXPECT_NEAR(more / some, std::pow(2.0, 0.875), 0.05 * std::pow(2.0, 0.875));
}

/// A bright and a black sheet meet in the middle of a column of pixels: two of four stratified samples lie on each.
/// If the wanted number exceeds the limit, each pixel at the edge or next to one takes as many samples as the limit
/// allows: this column and one on either side. If the sheets meet between two columns, no pixel's samples differ, but
/// its neighbours' do: both columns take as many as the limit allows.
TEST(AdaptiveFrame, EdgesArePaidForByThePixelsBesideThemAlone) {
  for (const auto& [column, taken] : {std::pair{20.5f, 3.0}, std::pair{20.0f, 2.0}}) {
    const float edge = column / 32;
    HandMadeScene made;
    made.add_quad({-2, -2, 0}, {edge, -2, 0}, {edge, 2, 0}, {-2, 2, 0}, test::matte(Rgb(0.0f), Rgb(1.0f)));
    made.add_quad({edge, -2, 0}, {2, -2, 0}, {2, 2, 0}, {edge, 2, 0}, test::matte(Rgb(0.0f)));
    const Lit lit(made.frame());
    const CameraView view = from_above();
    FrameOptions options;
    options.samples = 4;
    options.pixel_error = 1e-6;
    options.adaptive_limit = 16;
    EXPECT_DOUBLE_EQ(render_frame(lit.scene(), view, options).samples_per_pixel, 4 + 12 * taken / 64) << column;
  }
}

/// The rim of a lamp is seen in white, however bright the lamp is: a lamp 100 times as bright takes no more samples.
/// The picture's median is the sheet beside the lamp, so white is .1 / .18.
TEST(AdaptiveFrame, RimsOfLampsCountAsWhite) {
  const auto samples = [](float radiance) {
    HandMadeScene made;
    const float rim = 28.5f / 32;
    made.add_quad({-2, -2, 0}, {rim, -2, 0}, {rim, 2, 0}, {-2, 2, 0}, test::matte(Rgb(0.0f), Rgb(0.1f)));
    made.add_quad({rim, -2, 0}, {2, -2, 0}, {2, 2, 0}, {rim, 2, 0}, test::matte(Rgb(0.0f), Rgb(radiance)));
    const Lit lit(made.frame());
    FrameOptions options;
    options.samples = 4;
    options.pixel_error = 0.05;
    return render_frame(lit.scene(), from_above(), options).samples_per_pixel;
  };
  const double some = samples(10);
  EXPECT_GT(some, 4.2);
  EXPECT_DOUBLE_EQ(samples(1000), some);
}

/// A white and a black sheet under a lamp so far away that all light on one sheet is alike; they meet inside a column
/// of pixels. Light sampling is noisy in this column alone. If edges are known, this column alone takes the 12 samples
/// up to the limit, from 6 camera rays. Otherwise the pixels beside it do, too.
TEST(AdaptiveFrame, KnownEdgesAreComparedWithEdges) {
  const float edge = 20.3f / 32;
  HandMadeScene made;
  made.add_quad({-2, -2, 0}, {edge, -2, 0}, {edge, 2, 0}, {-2, 2, 0}, test::matte(Rgb(0.8f)));
  made.add_quad({edge, -2, 0}, {2, -2, 0}, {2, 2, 0}, {edge, 2, 0}, test::matte(Rgb(0.0f)));
  made.add_point_light({0, 0, 10000}, Rgb(1e8f));
  const Lit lit(made.frame());
  const CameraView view = from_above();
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.001;
  options.adaptive_limit = 16;
  const auto samples = [&] { return render_frame(lit.scene(), view, options).samples_per_pixel; };
  EXPECT_GT(samples(), 4 + 6 * 5.0 / 64);
  options.edges.assign(64 * 36, 0);
  for (std::size_t y = 0; y < 36; ++y) options.edges[64 * y + 32 + 20] = 1;
  EXPECT_DOUBLE_EQ(samples(), 4 + 6 * 1.0 / 64);
}

/// Everything else alike, a pixel at an edge gets twice the samples of one inside a surface; unknown ones lie between.
TEST(AdaptiveFrame, EdgesGetMoreSamplesBecauseTheFilterLeavesMoreOfTheirNoise) {
  const Cornell c;
  const NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 1;
  options.adaptive_limit = 1 << 20;
  options.pixel_error = 0.002;
  const auto samples = [&](std::vector<std::uint8_t> edges) {
    options.edges = std::move(edges);
    return render_frame(c.render_scene(), c.view, options).samples_per_pixel;
  };
  const std::size_t pixels = 64 * 36;
  const double at_edges = samples(std::vector<std::uint8_t>(pixels, 1)),
               inside = samples(std::vector<std::uint8_t>(pixels, 0));
  const double unknown = samples({});
  EXPECT_NEAR(at_edges / inside, 2, 0.1);
  EXPECT_LT(inside, unknown);
  EXPECT_LT(unknown, at_edges);
}

/// The border of the shadow of a sheet in front of a square lamp. The covered share of the lamp is p = (1 - s)^2 / 2
/// where x + y = (0.6 s - 0.5) / 0.4, and 0 from s = 1 on; the test looks at s from 0.82 to 0.99, p < 1.6 %. In 4 p of
/// the pixels one of four samples misses the lamp, and the pixel is 25 % dark. The mean over this part and all seeds is
/// right within 4 sigma. If further samples went to just these pixels, it would be .26 % too bright.
TEST(AdaptiveFrame, BordersOfShadowsKeepTheirMean) {
  HandMadeScene made;
  made.add_quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}, test::matte(Rgb(0.5f)));
  made.add_quad({-0.5f, -0.5f, 2}, {-0.5f, 0.5f, 2}, {0.5f, 0.5f, 2}, {0.5f, -0.5f, 2},
                test::matte(Rgb(0.0f), Rgb(1.0f)));
  made.add_quad({2.5f, -3, 1.2f}, {-3, 2.5f, 1.2f}, {-6, -0.5f, 1.2f}, {-0.5f, -6, 1.2f}, test::matte(Rgb(0.0f)));
  const Lit lit(made.frame());
  const CameraView view = from_above();
  const NoLight none(lit.tracer);
  const auto light_there = [&](const FrameOptions& options) {
    const RenderedFrame rendered = render_frame(lit.scene(), view, options);
    double light = 0;
    int looked_at = 0;
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 64; ++x) {
        const double u = (x + 0.5) / 32 - 1 + 0.5625 - (y + 0.5) / 32, s = (0.4 * u + 0.5) / 0.6;
        if (s < 0.82 || s > 0.99) continue;
        ++looked_at;
        light += double(rendered.mean.pixels[std::size_t(y * 64 + x)][Layer::direct].g);
      }
    EXPECT_GT(looked_at, 100);
    return light;
  };
  FrameOptions options;
  options.known = &none.known;
  options.samples = 1024;
  const double exact = light_there(options);
  options.samples = 4;
  options.pixel_error = 0.0125;
  Mean means;
  for (options.seed = 1; options.seed <= 32; ++options.seed) means.add(light_there(options) / exact - 1);
  EXPECT_NEAR(means.mean(), 0, 4 * means.sigma() + 0.0002);
  EXPECT_LT(means.sigma(), 4e-4);
}

/// Lamps of a 25th of a pixel in a mirror that shows .2 elsewhere: 16 % of the pixels with a lamp meet it with one of
/// their four samples. Their neighbours take further samples, they themselves do not, and the mean over the picture is
/// right within 4 sigma of 32 seeds. If pixels that met a lamp took more samples, 84 % of the lamps' light would be
/// lost, 9.6 % of all.
TEST(AdaptiveFrame, LampsSmallerThanPixelsKeepTheirLight) {
  Material mirror = test::matte(Rgb(1.0f));
  mirror.metallic = 1;
  mirror.roughness = 0;
  HandMadeScene made;
  made.add_quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, mirror);
  made.add_quad({-9, -9, 3}, {-9, 9, 3}, {9, 9, 3}, {9, -9, 3}, test::matte(Rgb(0.0f), Rgb(0.2f)));
  constexpr int kApart = 6, kAcross = 64 / kApart, kDown = 36 / kApart;
  constexpr float kPixel = 1 / 32.0f, kSide = kPixel / 5;
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAcross; ++i) {
      const float x = (kApart * float(i) + 2.1f) * kPixel - 1, y = 0.5625f - (kApart * float(j) + 2.1f) * kPixel;
      made.add_quad({x, y - kSide, 2}, {x, y, 2}, {x + kSide, y, 2}, {x + kSide, y - kSide, 2},
                    test::matte(Rgb(0.0f), Rgb(25.0f)));
    }
  const Lit lit(made.frame());
  const CameraView view = from_above();
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.0125;
  Mean means;
  for (options.seed = 1; options.seed <= 32; ++options.seed) {
    double mean = 0;
    for (const Layers& pixel : render_frame(lit.scene(), view, options).mean.pixels)
      mean += double(pixel[Layer::specular].g) / (64 * 36);
    means.add(mean);
  }
  const double lamps = kAcross * kDown / (64 * 36 * 25.0), exact = 0.2 + lamps * (25 - 0.2);
  EXPECT_NEAR(means.mean(), exact, 4 * means.sigma());
  EXPECT_LT(means.sigma(), 0.01 * exact);
}

}  // namespace
}  // namespace tempolux
