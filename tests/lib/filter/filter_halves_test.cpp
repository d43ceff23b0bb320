// Frames in halves with a known answer: noise on a wall, a star, a mirror, values that are not finite.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/error.h"
#include "lib/filter/filter_frame.h"
#include "tests/support/filter_frames.h"

namespace tempolux {
namespace {

using test::grey;
using test::OfPixel;
using test::wall;

constexpr int kSide = 96;

/// A wall whose layer has the mean `light`; each half has independent noise of standard deviation sigma.
Image noisy(const std::string& layer, const OfPixel& light, float sigma) {
  Image image = wall(kSide, kSide);
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0, sigma);
  std::vector<float> a(image.pixel_count()), b(image.pixel_count());
  for (float& v : a) v = sigma > 0 ? normal(random) : 0;
  for (float& v : b) v = sigma > 0 ? normal(random) : 0;
  const auto at = [](int x, int y) { return std::size_t(y * kSide + x); };
  test::set_noise(image, layer, [&](int x, int y) { return (a[at(x, y)] - b[at(x, y)]) / 2; });
  const OfPixel mean = [&](int x, int y) { return light(x, y) + (a[at(x, y)] + b[at(x, y)]) / 2; };
  grey(image, layer, mean);
  grey(image, "", mean);
  return image;
}

Image filtered(Image image) { return filter_alone(std::move(image)); }

double squared_error(const Image& image, const OfPixel& light) {
  double sum = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double off = double(image.find("G")->values[std::size_t(y * kSide + x)] - light(x, y));
      sum += off * off;
    }
  return sum / (kSide * kSide);
}

/// A plane over 169 pixels leaves 1 / 169 of the variance in the middle and up to 4 times that at the borders. The
/// choice has an error of a few per cent of w, which leaves (.1)^2 of the variance. The small window leaves 1 / 25
/// where it is taken. In all less than a tenth. The mean over the wall is that of the samples, to 1 / 10 of its own
/// error.
TEST(FilterHalves, NoiseOnAWallGoes) {
  const float sigma = 0.2f;
  const OfPixel light = [](int x, int y) { return 1 + 0.004f * float(x) - 0.002f * float(y); };
  for (const char* layer : {"direct", "indirect"})
    EXPECT_LT(squared_error(filtered(noisy(layer, light, sigma)), light), 0.1 * double(sigma) * double(sigma) / 2);
}

/// Light in a mirror is filtered by the surfaces that the mirror shows (seen.*): here two walls that meet at column 40.
/// Without these channels light crosses the border, or the halves prevent any filtering there.
TEST(FilterHalves, LightInAMirrorIsFilteredByWhatItShows) {
  const float sigma = 0.2f;
  const OfPixel light = [](int x, int) { return x < 40 ? 1.0f : 3.0f; };
  Image image = noisy("specular", light, sigma), direct = noisy("direct", test::everywhere(0), 0);
  for (Channel& channel : direct.channels)
    if (channel.name.starts_with("direct")) image.channels.push_back(channel);
  test::plane(image, "seen.Z", [](int x, int) { return x < 40 ? 3.0f : 5.0f; });
  test::plane(image, "seen.N.X", test::everywhere(0));
  test::plane(image, "seen.N.Y", test::everywhere(0));
  test::plane(image, "seen.N.Z", test::everywhere(1));
  for (const char* c : {"R", "G", "B"}) test::plane(image, std::string("seen.albedo.") + c, test::everywhere(1));
  image.add_ids("seen.id");
  EXPECT_LT(squared_error(filtered(std::move(image)), light), 0.12 * double(sigma) * double(sigma) / 2);
}

/// A star that both halves show is no noise: it keeps .95 of its contrast.
TEST(FilterHalves, AStarStays) {
  const OfPixel light = [](int x, int y) { return x == 50 && y == 40 ? 5.0f : 0.5f; };
  const Image out = filtered(noisy("direct", light, 0.05f));
  EXPECT_GT(out.find("R")->values[40 * kSide + 50], 0.5f + 0.95f * 4.5f);
}

TEST(FilterHalves, WhatIsNoNumberIsFilled) {
  Image image = noisy("direct", test::everywhere(1), 0.01f);
  for (const char* name : {"direct.noise.R", "direct.R", "R"})
    image.find(name)->values[30 * kSide + 30] = std::numeric_limits<float>::quiet_NaN();
  const Image out = filtered(std::move(image));
  for (const Channel& channel : out.channels)
    if (channel.name == "R" || channel.name == "direct.R") {
      for (const float v : channel.values) EXPECT_NEAR(v, 1, 0.06f);
    }
}

TEST(FilterHalves, HalvesWithoutTheirLayerAreRefused) {
  Image image = noisy("direct", test::everywhere(1), 0.01f);
  std::erase_if(image.channels, [](const Channel& channel) { return channel.name == "direct.G"; });
  EXPECT_THROW(FrameLight{image}, InputError);
}

}  // namespace
}  // namespace tempolux
