// Light that a single sample found: how much is taken, where it goes, what stays.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/render/spread_outliers.h"
#include "tests/support/frames.h"

namespace tempolux {
namespace {

constexpr float kError = 0.05f;

Material smooth_metal(float reflectance) {
  Material material = test::matte(Rgb(reflectance));
  material.metallic = 1;
  material.roughness = 0;
  return material;
}

/// A picture with four samples per pixel of part onward, all of indirect radiance 1.
struct Even {
  int width, height;
  std::vector<PathParts> parts;
  std::vector<PartCounts> counts;
  std::vector<BrightestSamples> brightest;
  std::vector<std::uint8_t> mask;
  std::function<double(double)> error = [](double) { return double(kError); };
  Even(int w, int h)
      : width(w),
        height(h),
        parts(std::size_t(w * h)),
        counts(parts.size(), PartCounts{4, 4, 4}),
        brightest(parts.size()) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      parts[p].own.coverage = 1;
      set(p, {Rgb(1.0f), Rgb(1.0f), Rgb(1.0f), Rgb(1.0f)});
    }
  }
  void set(std::size_t pixel, const std::array<Rgb, 4>& samples, Layer layer = Layer::indirect) {
    brightest[pixel] = {};
    parts[pixel].onward = {};
    for (const Rgb& radiance : samples) {
      PathParts sample;
      sample.onward[layer] = radiance;
      brightest[pixel].note(sample);
      parts[pixel].onward[layer] += radiance * 0.25f;
    }
  }
  std::vector<Layers> sums() const {
    std::vector<Layers> pixels;
    for (const PathParts& part : parts) pixels.push_back(part.sum());
    return pixels;
  }
  std::vector<Layers> spread() const {
    std::vector<Layers> pixels = sums();
    const SampledPixels samples{width, height, parts, counts, brightest, mask, error};
    spread_outliers(samples, allowed_errors(samples, pixels), pixels);
    return pixels;
  }
};

double sum_of(const std::vector<Layers>& pixels, Layer layer, int channel) {
  double sum = 0;
  for (const Layers& pixel : pixels) sum += double(pixel[layer][channel]);
  return sum;
}

/// A sample of 1000 among ones: its pixel shows 250.75, of which it may keep the error .05 and the 1 of its
/// surroundings in addition to the .75 of its other samples. The other 248.95 are spread over so many pixels that none
/// gets more than .05. The sum stays, up to the float rounding of 96000 pixels close to 1: 6e-8 each.
TEST(SpreadOutliers, WhatOneSampleClaimsIsSharedOutBelowTheError) {
  Even even(320, 300);
  const std::size_t middle = 150 * 320 + 160;
  even.set(middle, {Rgb(1.0f), Rgb(1000.0f), Rgb(1.0f), Rgb(1.0f)});
  const std::vector<Layers> pixels = even.spread();
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const float left = p == middle ? 1.8f : 1.0f, now = pixels[p][Layer::indirect].g;
    ASSERT_GE(now, left - 1e-4f) << p;
    ASSERT_LE(now, left + kError + 1e-4f) << p;
  }
  EXPECT_GT(pixels[middle + 40][Layer::indirect].g,
            1.005f);  // boxes of 65 pixels, because 33 would leave 249 x .5625 / 33^2 = .13
  EXPECT_NEAR(sum_of(pixels, Layer::indirect, 1), sum_of(even.sums(), Layer::indirect, 1), 96000 * 6e-8);
}

/// Two such samples of four do not confirm each other: each may leave 1.05, and the other two leave .5.
TEST(SpreadOutliers, TwoSamplesDoNotConfirmEachOther) {
  Even even(320, 300);
  const std::size_t middle = 150 * 320 + 160;
  even.set(middle, {Rgb(1.0f), Rgb(1000.0f), Rgb(1.0f), Rgb(800.0f)});
  const std::vector<Layers> pixels = even.spread();
  EXPECT_NEAR(pixels[middle][Layer::indirect].g, 2.6f, kError);
  EXPECT_NEAR(sum_of(pixels, Layer::indirect, 1), sum_of(even.sums(), Layer::indirect, 1), 96000 * 6e-8);
}

/// The left half of the picture is black and may err by .005, the right half shows 1 and may err by .05. The median is
/// 1, so white is 5.6. 30 pixels of the right half have a sample of 1000. Each claims L = 249, of which 4.6 are seen: D
/// = 4.6 / .05 = 91 errors. The whole picture has S = 48000 x .055 = 2640 and n = 96000, and the first outlier would
/// add n (L / S)^2 = 854 squared errors, the second three times as much, the third five times, which is below D^2 =
/// 8300; the tenth 19 times, which is not. No box is as wide as the picture, so fewer fit: at least one is spread and
/// most stay. With a limit for each outlier alone all 30 would be spread, and the dark half would glow. The median
/// within 5 x 5 pixels at the rim is that of a pixel's own side, and light goes in proportion to the error: the dark
/// side gets .1 of what the bright side gets, .11 with the change of B from pixel to pixel.
TEST(SpreadOutliers, ManyBrightOutliersStay) {
  Even even(320, 300);
  even.error = [](double level) { return level > 0.5 ? 0.05 : 0.005; };
  for (std::size_t p = 0; p < even.parts.size(); ++p)
    if (p % 320 < 160) even.set(p, {Rgb(0.0f), Rgb(0.0f), Rgb(0.0f), Rgb(0.0f)});
  for (std::size_t p = 0; p < 320; ++p) even.set(p, {Rgb(1.0f), Rgb(1.0f), Rgb(1.0f), Rgb(1.0f)});
  for (std::size_t i = 0; i < 30; ++i)
    even.set((5 + 10 * i) * 320 + 190, {Rgb(1.0f), Rgb(1000.0f), Rgb(1.0f), Rgb(1.0f)});
  const std::vector<Layers> before = even.sums(), pixels = even.spread();
  int spread = 0, whole = 0;
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const float got = pixels[p][Layer::indirect].g - before[p][Layer::indirect].g;
    spread += got < -200;
    whole += before[p][Layer::indirect].g > 200 && got >= 0;
  }
  EXPECT_GE(spread, 1);
  EXPECT_LT(spread, 10);
  EXPECT_EQ(spread + whole, 30);
  for (std::size_t y = 3; y < 300; ++y)
    ASSERT_LE(pixels[y * 320 + 159][Layer::indirect].g, 0.11f * (pixels[y * 320 + 160][Layer::indirect].g - 1) + 1e-6f)
        << y;
  EXPECT_NEAR(sum_of(pixels, Layer::indirect, 1), sum_of(before, Layer::indirect, 1), 1e-6 * 96000);
}

/// 30 pixels claim L = 10 beside 1: D = 4.6 / .05 = 91, D^2 = 8300. S = 96000 x .05 = 4800, so the last of them adds n
/// L / S (2 x 29 + 1) L / S = 25 squared errors at most: all are spread.
TEST(SpreadOutliers, ManyFaintOutliersAreSpread) {
  Even even(320, 300);
  even.error = [](double) { return 0.05; };
  for (std::size_t i = 0; i < 30; ++i)
    even.set((5 + 10 * i) * 320 + 190, {Rgb(1.0f), Rgb(41.0f), Rgb(1.0f), Rgb(1.0f)});
  const std::vector<Layers> pixels = even.spread();
  for (const Layers& pixel : pixels) ASSERT_LT(pixel[Layer::indirect].g, 2);
}

/// Smoke over nothing: no pixel may receive light, so all stays, and nothing is divided by 0.
TEST(SpreadOutliers, WithoutASurfaceNothingMoves) {
  Even even(64, 48);
  for (PathParts& part : even.parts) part.own.coverage = 0;
  even.set(77, {Rgb(0.0f), Rgb(1000.0f), Rgb(0.0f), Rgb(0.0f)}, Layer::volume);
  const std::vector<Layers> before = even.sums(), pixels = even.spread();
  for (std::size_t p = 0; p < pixels.size(); ++p)
    ASSERT_EQ(pixels[p][Layer::volume].g, before[p][Layer::volume].g) << p;
}

/// Pixels outside the mask count nowhere: with radiance 1 or 1000 there, the masked pixels have the same bytes.
TEST(SpreadOutliers, PixelsOutsideTheMaskCountNowhere) {
  Even even(64, 48);
  even.error = [](double level) { return 0.05 * level; };
  even.mask.assign(even.parts.size(), 0);
  for (std::size_t y = 25; y < 36; ++y)
    for (std::size_t x = 35; x < 46; ++x) even.mask[y * 64 + x] = 1;
  even.set(25 * 64 + 35, {Rgb(1.0f), Rgb(13.0f), Rgb(1.0f), Rgb(1.0f)});
  const std::vector<Layers> dark = even.spread();
  EXPECT_LT(dark[25 * 64 + 35][Layer::indirect].g, 2);
  for (std::size_t p = 0; p < even.parts.size(); ++p)
    if (!even.mask[p]) even.set(p, {Rgb(1000.0f), Rgb(1000.0f), Rgb(1000.0f), Rgb(1000.0f)});
  const std::vector<Layers> bright = even.spread();
  for (std::size_t p = 0; p < dark.size(); ++p)
    if (even.mask[p]) { ASSERT_EQ(bright[p][Layer::indirect].g, dark[p][Layer::indirect].g) << p; }
}

/// In a corner, in a picture so small that all pixels are close to a border, next to pixels without a surface, and
/// with errors that differ: the sum stays, and no light goes to pixels without a surface. A red sample gives no
/// green.
TEST(SpreadOutliers, SumsStayAtBordersAndBesideNothing) {
  Even even(37, 23);
  even.error = [](double level) { return 0.05 * std::sqrt(level); };
  for (std::size_t p = 0; p < even.parts.size(); ++p) {
    if (p % 37 > 30) {
      even.parts[p] = {};
      even.brightest[p] = {};
    }
  }
  for (const std::size_t p : {std::size_t(0), std::size_t(36 * 23 / 2), std::size_t(22 * 37 + 30)})
    even.set(p, {Rgb(1.0f), Rgb(50.0f, 1.0f, 1.0f), Rgb(1.0f), Rgb(1.0f)});  // 4.1 of light; room for 36
  const std::vector<Layers> before = even.sums(), pixels = even.spread();
  // Allowed: the mean 1.05 of the claimed 52 / 3 / 4 = 4.33, so 12.5 x 1.05 / 4.33 = 3.03 of the red, and .75 by the
  // three other samples; what comes back is below .2.
  EXPECT_LT(pixels[0][Layer::indirect].r, 4);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(sum_of(pixels, Layer::indirect, c), sum_of(before, Layer::indirect, c),
                1e-6 * sum_of(before, Layer::indirect, c))
        << c;
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    if (p % 37 > 30) {
      EXPECT_EQ(pixels[p][Layer::indirect].r, 0) << p;
    } else {
      EXPECT_GE(pixels[p][Layer::indirect].r, 0.99f) << p;
    }
  }
}

/// In a masked frame the pixels of the mask share light among themselves; a single pixel keeps its light.
TEST(SpreadOutliers, MaskedPixelsShareAmongThemselves) {
  Even even(64, 48);
  even.mask.assign(even.parts.size(), 0);
  const std::size_t alone = 10 * 64 + 10, inside = 30 * 64 + 40;
  even.mask[alone] = 1;
  for (std::size_t y = 25; y < 36; ++y)
    for (std::size_t x = 35; x < 46; ++x) even.mask[y * 64 + x] = 1;
  for (const std::size_t p : {alone, inside})
    even.set(p, {Rgb(1.0f), Rgb(13.0f), Rgb(1.0f), Rgb(1.0f)});  // 4: 2.2 too much
  const std::vector<Layers> before = even.sums(), pixels = even.spread();
  EXPECT_NEAR(pixels[alone][Layer::indirect].g, 4, 0.2);  // its place and the sheet are boxes of 9 apart
  EXPECT_LT(pixels[inside][Layer::indirect].g, 2);
  EXPECT_GT(pixels[inside + 3][Layer::indirect].g, 1.005f);
  EXPECT_NEAR(sum_of(pixels, Layer::indirect, 1), sum_of(before, Layer::indirect, 1), 64 * 48 * 6e-8);
  for (std::size_t p = 0; p < pixels.size(); ++p)
    if (!even.mask[p]) { EXPECT_EQ(pixels[p][Layer::indirect].g, 1) << p; }
}

/// Light on which a pixel's samples agree, light that the pixels around show, too, and light that the camera sees
/// itself are no outliers.
TEST(SpreadOutliers, WhatOthersSeeTooStays) {
  Even agreed(64, 48), line(64, 48), lamp(64, 48);
  agreed.set(24 * 64 + 32, {Rgb(50.0f), Rgb(52.0f), Rgb(48.0f), Rgb(50.0f)});
  for (std::size_t x = 0; x < 64; ++x)  // every fourth sample of a line is bright: 5 of the 24 around are of it
    line.set(24 * 64 + x, {Rgb(0.0f), Rgb(4.0f), Rgb(1.0f), Rgb(1.0f)});
  lamp.set(24 * 64 + 32, {Rgb(0.0f), Rgb(1000.0f), Rgb(0.0f), Rgb(0.0f)}, Layer::emission);
  for (const Even* even : {&agreed, &line, &lamp}) {
    const std::vector<Layers> before = even->sums(), pixels = even->spread();
    for (std::size_t p = 0; p < pixels.size(); ++p)
      for (std::size_t l = 0; l < kLayerCount; ++l) ASSERT_EQ(pixels[p].value[l].g, before[p].value[l].g) << p;
  }
}

/// In a picture whose lattice of first samples was black no error is known: all light stays, and nothing is divided by
/// 0. Values that are not finite stay, too.
TEST(SpreadOutliers, WithoutAnErrorNothingMoves) {
  Even black(64, 48), wild(64, 48);
  black.error = [](double) { return 0.0; };
  black.set(77, {Rgb(0.0f), Rgb(1000.0f), Rgb(0.0f), Rgb(0.0f)});
  wild.set(77, {Rgb(0.0f), Rgb(std::numeric_limits<float>::infinity()), Rgb(0.0f), Rgb(0.0f)});
  EXPECT_EQ(black.spread()[77][Layer::indirect].g, 250);
  const std::vector<Layers> pixels = wild.spread();
  for (std::size_t p = 0; p < pixels.size(); ++p)
    if (p != 77) { EXPECT_TRUE(std::isfinite(pixels[p][Layer::indirect].g)) << p; }
}

/// Of each part the layer in which it is brightest is noted.
TEST(SpreadOutliers, NotesTheBrightestLayerOfEachPart) {
  PathParts sample;
  sample.onward[Layer::indirect] = Rgb(9.0f);
  sample.own[Layer::specular] = Rgb(3.0f);
  sample.own[Layer::direct] = Rgb(5.0f);
  BrightestSamples all;
  all.note(sample);
  EXPECT_EQ(all.own.layer, Layer::direct);
  EXPECT_EQ(all.onward.radiance.g, 9);
  EXPECT_EQ(all.own.radiance.g, 5);
}

/// A room by paths, two samples per pixel, one onward: the sum of each layer is that without spreading, up to float
/// rounding, and the squared error of indirect light against 256 samples is smaller.
TEST(SpreadOutliers, AFrameKeepsItsLayersAndErrsLess) {
  const test::Cornell c;
  FrameOptions options;
  options.samples = 256;
  const RenderedFrame reference = render_frame(c.render_scene(), c.view, options);
  options.samples = 2;
  options.pixel_error = 0.02;
  options.adaptive_limit = 2;
  const RenderedFrame kept = render_frame(c.render_scene(), c.view, options);
  options.spread_outliers = true;
  const RenderedFrame spread = render_frame(c.render_scene(), c.view, options);
  EXPECT_GT(spread.spread, 0);
  double before = 0, after = 0;
  for (std::size_t p = 0; p < kept.mean.pixels.size(); ++p) {
    const auto error = [&](const RenderedFrame& frame) {
      return std::pow(
          double(frame.mean.pixels[p][Layer::indirect].g) - double(reference.mean.pixels[p][Layer::indirect].g), 2);
    };
    before += error(kept);
    after += error(spread);
  }
  EXPECT_LT(after, 0.9 * before);
  for (std::size_t l = 0; l < kLayerCount; ++l) {
    const double sum = sum_of(kept.mean.pixels, Layer(l), 1);
    EXPECT_NEAR(sum_of(spread.mean.pixels, Layer(l), 1), sum, 1e-5 * sum) << l;
  }
}

/// One of four samples has the radiance 41, and four samples are too few to judge it. Twelve more are taken; if three
/// of them find it, too, it stays, to the bit. If twelve find 1, it is spread: the pixel may keep the error and the 1
/// of its surroundings. A pixel with sixteen samples gets no more.
TEST(SpreadOutliers, WhatFurtherSamplesConfirmStays) {
  Even even(64, 48);
  const std::size_t claims = 20 * 64 + 30;
  even.set(claims, {Rgb(1.0f), Rgb(41.0f), Rgb(1.0f), Rgb(1.0f)});
  SampledPixels samples{even.width, even.height, even.parts, even.counts, even.brightest, even.mask, even.error};
  const std::vector<double> errors = allowed_errors(samples, even.sums());
  EXPECT_EQ(pixels_to_judge(samples, even.sums(), errors), std::vector<std::size_t>{claims});
  for (const auto& [mean, left] : {std::pair{11.0f, 11.0f}, std::pair{1.0f, 1.8f}}) {
    FurtherSamples further;
    further.mean.onward[Layer::indirect] = Rgb(mean);
    further.count = {12, 12, 12};
    samples.further = {{claims, further}};
    std::vector<Layers> pixels = even.sums();
    spread_outliers(samples, errors, pixels);
    EXPECT_NEAR(pixels[claims][Layer::indirect].g, left, mean > 1 ? 0 : kError + 1e-4) << mean;
  }
  samples.further = {};
  even.counts[claims] = {16, 16, 16};  // of which one brought 161
  EXPECT_EQ(pixels_to_judge(samples, even.sums(), errors), std::vector<std::size_t>{});
}

/// Sheets of a quarter of a pixel, 50 times as bright as the ground under a sky of radiance 1, twelve pixels apart: one
/// or two of four stratified samples meet a sheet, rightly. With or without spreading, their pixels keep their light:
/// the mean over all of them and eight seeds agrees within 5 %. If the four samples alone decided, they would keep a
/// third.
TEST(SpreadOutliers, ThingsSmallerThanPixelsKeepTheirContrast) {
  test::HandMadeScene made;
  made.add_quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, smooth_metal(0.02f));
  made.add_quad({-9, -9, 3}, {-9, 9, 3}, {9, 9, 3}, {9, -9, 3}, test::matte(Rgb(0.0f), Rgb(1.0f)));
  constexpr float kPixel = 1 / 32.0f;
  std::vector<std::size_t> stars;
  for (int j = 3; j < 36; j += 12)
    for (int i = 3; i < 64; i += 12) {
      const float x = (float(i) + 0.25f) * kPixel - 1, y = 0.5625f - (float(j) + 0.25f) * kPixel;
      made.add_quad({x, y - kPixel / 2, 0.1f}, {x + kPixel / 2, y - kPixel / 2, 0.1f}, {x + kPixel / 2, y, 0.1f},
                    {x, y, 0.1f}, smooth_metal(1));
      stars.push_back(std::size_t(j * 64 + i));
    }
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const CameraView view = test::from_above();
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.016;
  double light[2] = {0, 0};
  for (const bool spread : {false, true})
    for (options.seed = 1; options.seed <= 8; ++options.seed) {
      options.spread_outliers = spread;
      const RenderedFrame rendered = render_frame({tracer, lights}, view, options);
      for (const std::size_t star : stars) light[spread] += double(rendered.mean.pixels[star][Layer::specular].g);
    }
  EXPECT_GT(light[0] / (8 * double(stars.size())), 0.15);
  EXPECT_NEAR(light[1] / light[0], 1, 0.05);
}

}  // namespace
}  // namespace tempolux
