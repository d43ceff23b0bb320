// The noise that a frame reports against the noise between seeds; the loop of --seen-error.
#include "lib/image/srgb.h"
#include "lib/render/frame_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

using test::Cornell;
using test::NoLight;

/// 255 (1.055 x .18^(1/2.4) - .055) = 117.6; below .0031308 the line 255 x 12.92 v; values are clipped at 0 and 1.
TEST(FrameNoise, CodesAreThoseOfSrgb) {
  EXPECT_NEAR(srgb_code(0.18), 117.65, 0.05);
  EXPECT_NEAR(srgb_code(0.001), 3.2946, 1e-4);
  EXPECT_EQ(srgb_code(-1), 0);
  EXPECT_NEAR(srgb_code(7), 255, 1e-9);
}

/// The median goes to .18: for 1, 2 and 4 the exposure is .09. Masked pixels do not count, nor does black if it is
/// more than half of the picture.
TEST(FrameNoise, ExposureIsByTheMedian) {
  std::vector<Layers> pixels(3);
  pixels[0][Layer::direct] = Rgb(1.0f), pixels[1][Layer::direct] = Rgb(4.0f), pixels[2][Layer::direct] = Rgb(2.0f);
  EXPECT_NEAR(exposure_of(pixels, {}), 0.09, 1e-9);
  const std::vector<std::uint8_t> mask{0, 1, 0};
  EXPECT_NEAR(exposure_of(pixels, mask), 0.045, 1e-9);
  pixels.resize(40);
  EXPECT_NEAR(exposure_of(pixels, {}), 0.09, 1e-9);
  EXPECT_EQ(exposure_of(std::vector<Layers>(4), {}), 1);
}

/// The median 2 goes to .18, so white is 2 / .18 = 11.1, and the lamp of 1000 counts as 11.1: (1 + 2 + 11.1) / 3.
TEST(FrameNoise, ALampInViewCountsAsWhite) {
  EXPECT_NEAR(mean_to_white({1, 1000, 2}), (1 + 2 + 2 / 0.18) / 3, 1e-9);
  EXPECT_NEAR(mean_to_white({1, 4, 2}), 7.0 / 3, 1e-9);
  EXPECT_EQ(mean_to_white({}), 0);
}

/// Samples without noise that read records whose noise is .02 in layer indirect: the frame has that noise, in the layer
/// and in the image, and no other layer has any.
TEST(FrameNoise, IncludesTheNoiseOfRecords) {
  const Cornell c;
  NoiseCheck check(c.view, 1, {});
  Layers sample;
  sample[Layer::indirect] = Rgb(0.5f);
  for (std::uint32_t slot = 0; slot < check.size(); ++slot) check.again(slot).own = sample;
  const std::vector<Layers> picture(64 * 36, sample);
  const std::vector<StoredNoise> known(picture.size(), {Rgb(0.0f), Rgb(0.02f)});
  const FrameNoise noise = check.measure(
      picture, [&](std::size_t pixel) { return picture[pixel]; }, known);
  EXPECT_NEAR(noise.image.linear, 0.02, 1e-6);
  EXPECT_NEAR(noise.layer[std::size_t(Layer::indirect)].linear, 0.02, 1e-6);
  EXPECT_NEAR(noise.stored_codes, noise.image.codes, 1e-3);
  EXPECT_EQ(noise.layer[std::size_t(Layer::direct)].linear, 0);
}

/// Mean squares that frames report over 12 seeds, against the variance between the seeds' pictures, with fixed and
/// adaptive samples. Each frame renders 84 pixels twice, so a frame's variance is known within 15 to 30 % and the mean
/// over seeds within 10 %; the band is 25 %. Halves of the pixels' own samples would report 1.9 times the variance of
/// direct light.
TEST(FrameNoise, IsThatBetweenSeeds) {
  const Cornell c;
  const NoLight none(c.tracer);
  FrameOptions options;
  options.known = &none.known;
  options.samples = 4;
  constexpr int kSeeds = 12;
  for (const double pixel_error : {0.0, 0.02}) {
    options.pixel_error = pixel_error;
    std::vector<Rgbd> sum(64 * 36, Rgbd(0.0)), square(64 * 36, Rgbd(0.0));
    double said = 0, error = 0;
    for (options.seed = 1; options.seed <= kSeeds; ++options.seed) {
      const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
      ASSERT_TRUE(frame.noise.known());
      EXPECT_EQ(frame.noise.pixels, 84u);  // 12 x 7 squares of 5
      const Noise& noise = frame.noise.layer[std::size_t(Layer::direct)];
      said += noise.linear * noise.linear / kSeeds;
      error += noise.linear_error / noise.linear / kSeeds;
      for (std::size_t p = 0; p < sum.size(); ++p) {
        const Rgbd value(frame.mean.pixels[p][Layer::direct]);
        sum[p] += value;
        square[p] += value * value;
      }
    }
    double measured = 0;
    for (std::size_t p = 0; p < sum.size(); ++p)
      measured += channel_mean(square[p] - sum[p] * sum[p] * (1.0 / kSeeds)) / (kSeeds - 1) / double(sum.size());
    EXPECT_NEAR(said / measured, 1, 0.25) << pixel_error;
    EXPECT_GT(error, 0.03);
    EXPECT_LT(error, 0.3);
  }
}

/// If 2 codes or half of that are requested, the difference of two seeds' frames of paths is at most 15 % larger and at
/// least half as large. A goal that adaptive_limit prevents is not reached, and the frame reports this.
TEST(FrameNoise, SeenErrorIsReachedOrNot) {
  const Cornell c;
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.02;
  const auto codes = [](const RenderedFrame& a, const RenderedFrame& b) {
    double sum = 0;
    for (std::size_t p = 0; p < a.mean.pixels.size(); ++p) {
      Rgbd x(0.0), y(0.0);
      for (std::size_t l = 0; l < kLayerCount; ++l)
        x += Rgbd(a.mean.pixels[p].value[l]), y += Rgbd(b.mean.pixels[p].value[l]);
      for (int i = 0; i < 3; ++i) {
        const double d = srgb_code(x[i] * a.noise.exposure) - srgb_code(y[i] * a.noise.exposure);
        sum += d * d / (6.0 * double(a.mean.pixels.size()));
      }
    }
    return std::sqrt(sum);
  };
  for (const double asked : {4.0, 2.0}) {
    options.seen_error = asked;
    options.seed = 1;
    const RenderedFrame a = render_frame(c.render_scene(), c.view, options);
    options.seed = 2;
    const RenderedFrame b = render_frame(c.render_scene(), c.view, options);
    EXPECT_LE(a.noise.image.codes, asked);
    EXPECT_LE(codes(a, b), 1.15 * asked);
    EXPECT_GE(codes(a, b), 0.5 * asked);
    EXPECT_LT(a.at_limit, 0.5);
  }
  options.seen_error = 0.2;
  options.adaptive_limit = 8;
  const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
  EXPECT_GT(frame.noise.image.codes, 0.2);
  EXPECT_GT(frame.at_limit, 0.5);
}

/// A record with large noise lights the floor in view. The frame does not reach the requested noise, since all samples
/// read the record. Samples stop when their own noise is half of what is requested, long before the limit.
TEST(FrameNoise, SamplesStopWhereRecordsHaveTheNoise) {
  const Cornell c;
  RecordStore store(0);
  ASSERT_TRUE(store.add(c.record_at({32, 30}, 2, Rgb(1.0f))));
  KnownLight known;
  known.records = &store;
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.02;
  options.seen_error = 4;
  options.known = &known;
  const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
  EXPECT_GT(frame.noise.stored_codes, 4);
  EXPECT_LE(frame.noise.image.codes, std::hypot(frame.noise.stored_codes, 2));
  EXPECT_LT(frame.at_limit, 0.05);
}

}  // namespace
}  // namespace tempolux
