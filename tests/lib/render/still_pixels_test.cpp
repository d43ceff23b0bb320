// Frames that keep pixels of another moment.
#include "lib/render/still_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

using test::Cornell;
using test::HandMadeScene;
using test::Lit;

StillPixels compared(const RenderScene& now, const RenderScene& before, const CameraView& view,
                     const FrameOptions& options, const KnownLight* known = nullptr,
                     const KnownLight* known_before = nullptr, const Image& base = {}) {
  return still_pixels({now, view, known, options.seed}, {before, view, known_before, options.seed}, base, options);
}

FrameOptions usual() {
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.03;
  return options;
}

/// Both moments are the same: no pixel is sampled anew, and every change is exactly 0.
TEST(StillPixels, NothingChangesAtOneMoment) {
  const Cornell c;
  const StillPixels still = compared(c.render_scene(), c.render_scene(), c.view, usual());
  EXPECT_EQ(still.share_anew(), 0);
  for (const Layers& change : still.change.pixels) EXPECT_EQ(radiance_of(change), 0);
}

/// A screen that fills the view shines with 3 W/m^2/sr, before with 1. The camera sees it directly, so each sample
/// differs by 2: the change has no noise, and no pixel is sampled anew.
TEST(StillPixels, AChangeWithoutNoiseIsAdded) {
  const auto screen = [](float radiance) {
    Material material;
    material.emission = Rgb(radiance);
    HandMadeScene scene;
    scene.add_quad({-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, material);
    return scene;
  };
  HandMadeScene bright = screen(3), dim = screen(1);
  const Lit now(bright.frame()), before(dim.frame());
  const CameraView view = test::from_above();
  const StillPixels still = compared(now.scene(), before.scene(), view, usual());
  EXPECT_EQ(still.share_anew(), 0);
  Image image{view.width(), view.height(), {}, {}, {}, {}};
  for (const char* name : {"R", "G", "B", "emission.R", "emission.G", "emission.B"}) {
    std::vector<float>& values = image.add(name).values;
    std::ranges::fill(values, 1.0f);
  }
  add_change(still, image);
  for (const char* name : {"R", "emission.G"})
    for (const float value : image.find(name)->values) ASSERT_FLOAT_EQ(value, 3);
}

/// A box moves, and direct light changes. Kept pixels, which add the change to pixels of eight frames before, have the
/// light of their own moment: 64 seeds against 1024 samples, 4 standard errors of the seeds' mean and 4 of the
/// references
/// (.05 % of the picture each).
TEST(StillPixels, KeptPixelsHaveTheLightOfTheirMoment) {
  const Cornell now(18, 32, 18), before(10, 32, 18);
  const test::NoLight none(now.tracer), none_before(before.tracer);
  FrameOptions reference = usual(), many = usual();
  reference.known = &none.known;
  many.known = &none_before.known;
  reference.pixel_error = many.pixel_error = 0;
  reference.samples = many.samples = 1024;
  many.seed = 77;
  const RenderedFrame right = render_frame(now.render_scene(), now.view, reference),
                      base = render_frame(before.render_scene(), now.view, many);
  constexpr int kSeeds = 64;
  double kept_share = 0;
  std::vector<double> errors;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    FrameOptions options = usual();
    options.seed = std::uint64_t(seed);
    const StillPixels still =
        compared(now.render_scene(), before.render_scene(), now.view, options, &none.known, &none_before.known);
    double error = 0;
    for (std::size_t p = 0; p < still.anew.size(); ++p) {
      if (still.anew[p]) continue;
      error +=
          radiance_of(base.mean.pixels[p]) + radiance_of(still.change.pixels[p]) - radiance_of(right.mean.pixels[p]);
    }
    errors.push_back(error / double(still.anew.size()));
    kept_share += (1 - still.share_anew()) / kSeeds;
  }
  double mean = 0, square = 0;
  for (const double error : errors) mean += error / kSeeds;
  for (const double error : errors) square += (error - mean) * (error - mean);
  const double of_seeds = std::sqrt(square / (kSeeds - 1) / kSeeds);
  EXPECT_GT(kept_share, 0.3);
  EXPECT_LT(kept_share, 0.98);
  EXPECT_NEAR(mean, 0, 4 * (of_seeds + 0.0005 * right.mean_radiance)) << "mean radiance " << right.mean_radiance;
}

/// A small bright lamp above a floor.
HandMadeScene lit_floor(float radiance) {
  Material lamp, floor;
  lamp.emission = Rgb(radiance);
  floor.base_color = Rgb(0.5f);
  HandMadeScene scene;
  scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, floor);
  scene.add_quad({0.8f, -1, 0.5f}, {0.8f, 1, 0.5f}, {1.2f, 1, 0.5f}, {1.2f, -1, 0.5f}, lamp);
  return scene;
}

/// A lamp above a floor becomes a tenth brighter. Each sample, and so each pixel, becomes a tenth brighter: the change
/// of the kept pixels is a tenth of their light before, to 4 standard errors over 32 seeds. (With the opposite
/// difference it would be minus a tenth.)
TEST(StillPixels, ASmallChangeOfNoisyLightIsKnownWell) {
  HandMadeScene bright = lit_floor(1.1f), dim = lit_floor(1);
  const Lit now(bright.frame()), before(dim.frame());
  const CameraView view = test::from_above();
  FrameOptions many;
  many.samples = 1024;
  const RenderedFrame base = render_frame(before.scene(), view, many);
  std::vector<double> ratios;
  for (int seed = 1; seed <= 32; ++seed) {
    FrameOptions options = usual();
    options.seed = std::uint64_t(seed);
    const StillPixels still = compared(now.scene(), before.scene(), view, options);
    EXPECT_LT(still.share_anew(), 0.5);
    double change = 0, light = 0;
    for (std::size_t p = 0; p < still.anew.size(); ++p)
      if (!still.anew[p]) change += radiance_of(still.change.pixels[p]), light += radiance_of(base.mean.pixels[p]);
    ratios.push_back(change / light);
  }
  double mean = 0, square = 0;
  for (const double ratio : ratios) mean += ratio / 32;
  for (const double ratio : ratios) square += (ratio - mean) * (ratio - mean);
  EXPECT_NEAR(mean, 0.1, 4 * std::sqrt(square / 31 / 32) + 1e-5);
}

/// The lamp shines at one moment only: a difference is as noisy as a sample of one moment and costs twice as much. So
/// all noisy pixels are sampled anew.
TEST(StillPixels, WhereMomentsHaveNothingInCommonPixelsAreSampledAnew) {
  HandMadeScene bright = lit_floor(1), dark = lit_floor(1e-6f);
  const Lit now(bright.frame()), before(dark.frame());
  FrameOptions options = usual();
  options.pixel_error = 0.003;
  const StillPixels still = compared(now.scene(), before.scene(), test::from_above(), options);
  EXPECT_GT(still.share_anew(), 0.9);
  EXPECT_GT(still.work, 1);
}

/// The lamp becomes a tenth brighter, and few errors are allowed: kept pixels get further differences. The mean square
/// of their noise channel is the variance of their light over 24 seeds. (The variance is known to a few percent, the
/// noise to a tenth, the root of 3 / 300 pixels that are rendered twice.)
TEST(StillPixels, TheNoiseOfTheChangeIsStored) {
  HandMadeScene bright = lit_floor(1.1f), dim = lit_floor(1);
  const Lit now(bright.frame()), before(dim.frame());
  const CameraView view = test::from_above();
  constexpr int kSeeds = 24;
  std::vector<double> sum(view.width() * std::size_t(view.height())), square(sum), said(sum);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    FrameOptions options = usual();
    options.seed = std::uint64_t(seed);
    options.pixel_error = 0.002;
    options.sample_halves = true;
    const StillPixels still = compared(now.scene(), before.scene(), view, options);
    EXPECT_LT(still.share_anew(), 0.1);
    EXPECT_GT(still.samples_per_pixel, 3) << "of two first samples";
    Image image{view.width(), view.height(), {}, {}, {}, {}};
    for (const char* name : {"specular.R", "specular.noise.R"}) image.add(name);
    std::ranges::fill(image.find("specular.R")->values, 1.0f);
    add_change(still, image);
    for (std::size_t p = 0; p < sum.size(); ++p) {
      const double value = double(image.find("specular.R")->values[p]),
                   noise = double(image.find("specular.noise.R")->values[p]);
      sum[p] += value;
      square[p] += value * value;
      said[p] += noise * noise / kSeeds;
    }
  }
  double variance = 0, of_noise = 0;
  for (std::size_t p = 0; p < sum.size(); ++p) {
    variance += (square[p] - sum[p] * sum[p] / kSeeds) / (kSeeds - 1);
    of_noise += said[p];
  }
  EXPECT_GT(variance, 0);
  EXPECT_NEAR(of_noise / variance, 1, 0.3);
}

}  // namespace
}  // namespace tempolux
