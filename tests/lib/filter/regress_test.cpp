// The fit to features of blurred frames, against light that is linear in what pixels show.
#include "lib/filter/regress.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"
#include "tests/support/filter_frames.h"

namespace tempolux {
namespace {

using test::at;
using test::everywhere;
using test::plane;

constexpr int kSize = 48;

/// A number in [0, 1) for each pixel.
float share_at(int x, int y) { return unit_float(std::uint32_t(mix64(std::uint64_t(y * kSize + x)) >> 32)); }

/// A blurred frame of a front and a back: `share` of each pixel shows the front, of albedo .8, 1 m away, normal (0, 0,
/// 1); the rest shows the back, of albedo .2, 4 m away, normal (1, 0, 0).
Image soft_frame(const test::OfPixel& share) {
  Image image = test::wall(kSize, kSize);
  const auto mixed = [&](float front, float back) {
    return [=, &share](int x, int y) { return back + (front - back) * share(x, y); };
  };
  plane(image, "coverage.mean.N.X", mixed(0, 1));
  plane(image, "coverage.mean.N.Y", everywhere(0));
  plane(image, "coverage.mean.N.Z", mixed(1, 0));
  plane(image, "coverage.mean.inverse_Z", mixed(1, 0.25f));
  test::grey(image, "albedo", mixed(0.8f, 0.2f));
  test::grey(image, "coverage.mean.albedo", mixed(0.8f, 0.2f));
  return image;
}

/// Adds the layer direct, with noise of this deviation in each half.
void light(Image& image, const test::OfPixel& radiance, float deviation) {
  test::Noise noise(deviation);
  std::vector<float> a, b;
  for (int i = 0; i < kSize * kSize; ++i) a.push_back(noise()), b.push_back(noise());
  const auto of = [](const std::vector<float>& v, int x, int y) { return v[std::size_t(y * kSize + x)]; };
  test::grey(image, "direct", [&](int x, int y) { return radiance(x, y) + (of(a, x, y) + of(b, x, y)) / 2; });
  test::set_noise(image, "direct", [&](int x, int y) { return (of(a, x, y) - of(b, x, y)) / 2; });
}

/// The mean of both halves of the fit.
std::vector<float> fitted(const Image& image) {
  const LightGroup group(image, false, {"direct"});
  const std::vector<Halves> halves = regress(image, group, Features(image));
  std::vector<float> mean;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) mean.push_back(mean_of(halves[0].a[1][p], halves[0].b[1][p]));
  return mean;
}

double error(const std::vector<float>& values, const test::OfPixel& truth, int left = 0, int right = kSize) {
  double sum = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = left; x < right; ++x) {
      const double off = double(values[std::size_t(y * kSize + x)] - truth(x, y));
      sum += off * off;
    }
  return std::sqrt(sum / (kSize * (right - left)));
}

/// A front of radiance 3 and a back of 1, whose shares differ from pixel to pixel: no pixel shows one of them alone,
/// and neighbours are no help without features. Noise of 1.5 in each half, 1.06 in their mean. The fit has 4 unknowns
/// here (place, share) and about half of 81 pixels, as weights are those of other pixels' noise: 1.06 sqrt(4 / 40) =
/// .34, less than the shares' own deviation 2 / sqrt(12) = .58. Meant to catch: a fit to places alone (.6), features of
/// another pixel, weights of the half itself (its noise then stays).
TEST(Regress, SharesOfPixelsExplainTheirLight) {
  Image image = soft_frame(share_at);
  const auto truth = [](int x, int y) { return 1 + 2 * share_at(x, y); };
  light(image, truth, 1.5f);
  EXPECT_NEAR(error(image.find("direct.G")->values, truth), 1.06, 0.05);
  EXPECT_LT(error(fitted(image), truth), 0.34);
}

/// A border of light on one surface, 1 and 5 with noise of .2 in each half, .14 in their mean: patches tell both sides
/// apart, so beside the border half of the window's 81 pixels count. A plane's value at the border of its pixels has
/// four times the variance of a mean: .14 sqrt(4 / 40) = .045, and .14 sqrt(1 / 81) = .016 inside; as much again for
/// what unequal weights lose. Meant to catch: no weights (1 beside the border).
TEST(Regress, AStepOfLightOnOneSurfaceStays) {
  Image image = soft_frame(everywhere(1));
  const auto truth = [](int x, int) { return x < 24 ? 1.0f : 5.0f; };
  light(image, truth, 0.2f);
  const std::vector<float> values = fitted(image);
  EXPECT_LT(error(values, truth), 0.045);
  EXPECT_LT(error(values, truth, 22, 26), 0.09);
}

/// Three features that differ by noise alone, of variance .01. Where the frame says so, they are not taken for shares:
/// their variance counts twice, which halves the slopes that noise
/// of light gives them. Ten unknowns leave sqrt(10 / 81) of the noise, seven .84 of that, so .93 lies above what half
/// slopes leave. Meant to catch: errors that are not read.
TEST(Regress, NoiseOfFeaturesIsNoShare) {
  test::Noise noise(0.1f);
  std::vector<float> off;
  for (int i = 0; i < kSize * kSize; ++i) off.push_back(noise());
  const auto frame = [&](bool known) {
    Image image = soft_frame(everywhere(0.5f));
    for (const char* name : {"N.X", "N.Y", "N.Z"}) {
      for (std::size_t p = 0; p < off.size(); ++p)
        image.find(std::string("coverage.mean.") + name)->values[p] +=
            off[(p * 7 + std::size_t(name[2]) * 331) % off.size()];
      if (known) plane(image, std::string("coverage.error.") + name, everywhere(0.1f));
    }
    light(image, everywhere(2), 0.5f);
    return image;
  };
  const double without = error(fitted(frame(false)), everywhere(2)), with = error(fitted(frame(true)), everywhere(2));
  EXPECT_LT(with, 0.93 * without);
}

/// Each half of a pixel finds 50 with the chance 1 / 50, else nothing: a mean of 1, of which the raw frame errs by 5.
/// The weights of a half come from the other one, which does not know where this half was lucky, so bright samples
/// spread over the pixels around: 81 equal weights leave a ninth of the error; unequal ones here at most twice that.
/// Meant to catch: weights from the half itself, with which lucky pixels keep their light (.31 of the error).
TEST(Regress, AHalfDoesNotChooseItsWeights) {
  Image image = soft_frame(everywhere(1));
  const auto lucky = [](int x, int y, int half) {
    return mix64(std::uint64_t((y * kSize + x) * 2 + half)) % 50 == 0 ? 50.0f : 0.0f;
  };
  test::grey(image, "direct", [&](int x, int y) { return (lucky(x, y, 0) + lucky(x, y, 1)) / 2; });
  test::set_noise(image, "direct", [&](int x, int y) { return (lucky(x, y, 0) - lucky(x, y, 1)) / 2; });
  const double raw = error(image.find("direct.G")->values, everywhere(1)), after = error(fitted(image), everywhere(1));
  EXPECT_LT(after, 2 * raw / 9);
}

/// A pixel that is not finite changes no other, and gets the light of those around.
TEST(Regress, StrangePixelsCountNothing) {
  Image image = soft_frame(share_at);
  const auto truth = [](int x, int y) { return 1 + 2 * share_at(x, y); };
  light(image, truth, 0.2f);
  for (const char* c : {"R", "G", "B"}) image.find(std::string("direct.") + c)->values[20 * kSize + 20] = NAN;
  image.find("direct.noise.G")->values[30 * kSize + 30] = INFINITY;
  const std::vector<float> values = fitted(image);
  for (std::size_t p = 0; p < values.size(); ++p) ASSERT_TRUE(std::isfinite(values[p])) << p;
  EXPECT_LT(error(values, truth), 0.25);
}

/// The frame of the first test as frames come, with noise of 1 in each half, .71 in their mean: the whole filter takes
/// the fit, and leaves less than without means, as no pixel shows one surface. A frame without means has no features.
TEST(Regress, ABlurredFrameHasLessNoiseInSoftEdges) {
  const auto truth = [](int x, int y) { return 1 + 2 * share_at(x, y); };
  Image image = soft_frame(share_at);
  light(image, truth, 1);
  std::vector<std::uint32_t>& other = image.add_ids("coverage.other").ids;
  image.add_ids("coverage");
  std::fill(other.begin(), other.end(), 8);
  Image sharp = image;
  std::erase_if(sharp.channels, [](const Channel& c) { return c.name.starts_with("coverage.mean"); });
  EXPECT_FALSE(Features(sharp).known());
  const double raw = error(image.find("direct.G")->values, truth);
  const double with = error(test::filtered({image}).find("direct.G")->values, truth);
  const double without = error(test::filtered({sharp}).find("direct.G")->values, truth);
  EXPECT_LT(with, 0.6 * raw);
  EXPECT_LT(with, 0.8 * without);
}

}  // namespace
}  // namespace tempolux
