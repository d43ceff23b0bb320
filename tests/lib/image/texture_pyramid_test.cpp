// Textures against texel values worked out by hand.
#include "lib/image/texture_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/error.h"
#include "lib/image/texture_images.h"
#include "tests/lib/image/image_fixture.h"
#include "tests/support/png_bytes.h"

namespace tempolux {
namespace {

constexpr TextureWrap kRepeat = TextureWrap::repeat, kMirrored = TextureWrap::mirrored, kClamp = TextureWrap::clamp;

/// A row of four grey texels of linear values 0, 51, 102 and 255 / 255.
TexturePyramid row() { return {CodedPixels{4, 1, 1, 8, {0, 51, 102, 255}}, TextureTransfer::linear}; }
float at(const TexturePyramid& texture, float u, TextureWrap wrap, bool nearest = false, float level = 0) {
  return texture.read({u, 0.5f}, wrap, wrap, nearest, level)[0];
}

TEST(TexturePyramid, TexelCentresAreExactAndBetweenThemIsLinear) {
  const TexturePyramid texture = row();
  EXPECT_FLOAT_EQ(at(texture, 0.125f, kRepeat), 0);
  EXPECT_FLOAT_EQ(at(texture, 0.375f, kRepeat), 0.2f);
  EXPECT_FLOAT_EQ(at(texture, 0.625f, kRepeat), 0.4f);
  EXPECT_FLOAT_EQ(at(texture, 0.5f, kRepeat), 0.3f);
  EXPECT_FLOAT_EQ(at(texture, 0.8125f, kRepeat), 0.4f + 0.75f * 0.6f);
}

TEST(TexturePyramid, WrapModes) {
  const TexturePyramid texture = row();
  // At the border between the last and the first texel.
  EXPECT_FLOAT_EQ(at(texture, 0, kRepeat), 0.5f);
  EXPECT_FLOAT_EQ(at(texture, 1, kRepeat), 0.5f);
  EXPECT_FLOAT_EQ(at(texture, 0, kClamp), 0);
  EXPECT_FLOAT_EQ(at(texture, 1, kClamp), 1);
  EXPECT_FLOAT_EQ(at(texture, 0, kMirrored), 0);
  EXPECT_FLOAT_EQ(at(texture, 1, kMirrored), 1);
  // Beyond, both ways.
  for (const float beyond : {1.375f, -0.625f, 7.375f}) EXPECT_NEAR(at(texture, beyond, kRepeat), 0.2f, 1e-6);
  EXPECT_FLOAT_EQ(at(texture, 1.375f, kClamp), 1);
  EXPECT_FLOAT_EQ(at(texture, -0.625f, kClamp), 0);
  EXPECT_FLOAT_EQ(at(texture, 1.375f, kMirrored), 0.4f);  // 2 - 1.375 = 0.625
  EXPECT_FLOAT_EQ(at(texture, -0.375f, kMirrored), 0.2f);
  EXPECT_FLOAT_EQ(at(texture, 2.375f, kMirrored), 0.2f);
  for (const float bad : {INFINITY, -INFINITY, NAN, 1e30f, -1e30f}) {
    const float value = at(texture, bad, kRepeat);
    EXPECT_TRUE(value >= 0 && value <= 1) << bad;
  }
}

TEST(TexturePyramid, Nearest) {
  const TexturePyramid texture = row();
  EXPECT_FLOAT_EQ(at(texture, 0.49f, kRepeat, true), 0.2f);
  EXPECT_FLOAT_EQ(at(texture, 0.51f, kRepeat, true), 0.4f);
  EXPECT_FLOAT_EQ(at(texture, -0.01f, kRepeat, true), 1);
  EXPECT_FLOAT_EQ(at(texture, 1, kClamp, true), 1);
}

TEST(TexturePyramid, ColoursAreDecodedFromSrgbAndAlphaIsNot) {
  // IEC 61966-2-1: code 188 is ((188/255 + 0.055) / 1.055)^2.4 = 0.502886 linear, 10 is 10 / 255 / 12.92.
  const TexturePyramid texture{CodedPixels{1, 1, 4, 8, {188, 10, 255, 128}}, TextureTransfer::srgb};
  const Rgba value = texture.texel(0, 0, 0);
  EXPECT_NEAR(value[0], 0.502886f, 1e-5);
  EXPECT_NEAR(value[1], 10.0f / 255 / 12.92f, 1e-7);
  EXPECT_FLOAT_EQ(value[2], 1);
  EXPECT_FLOAT_EQ(value[3], 128.0f / 255);
  const TexturePyramid numbers{CodedPixels{1, 1, 2, 8, {188, 128}}, TextureTransfer::linear};
  EXPECT_FLOAT_EQ(numbers.texel(0, 0, 0)[2], 188.0f / 255);  // grey on all three
  EXPECT_FLOAT_EQ(numbers.texel(0, 0, 0)[3], 128.0f / 255);
}

TEST(TexturePyramid, SixteenBits) {
  const std::uint16_t codes[3] = {65535, 1000, 0};
  CodedPixels pixels{1, 1, 3, 16, std::vector<std::uint8_t>(6)};
  std::memcpy(pixels.bytes.data(), codes, 6);
  const TexturePyramid texture{pixels, TextureTransfer::linear};
  EXPECT_FLOAT_EQ(texture.texel(0, 0, 0)[0], 1);
  EXPECT_FLOAT_EQ(texture.texel(0, 0, 0)[1], 1000.0f / 65535);
  EXPECT_FLOAT_EQ(texture.texel(0, 0, 0)[2], 0);
}

TEST(TexturePyramid, LevelsAreMeansOfLinearLight) {
  // Black and white in a checker: half the light, which is code 188 in sRGB (127 would be a mean of codes).
  const TexturePyramid texture{CodedPixels{2, 2, 1, 8, {0, 255, 255, 0}}, TextureTransfer::srgb};
  ASSERT_EQ(texture.level_count(), 2);
  EXPECT_NEAR(texture.texel(1, 0, 0)[0], 0.5f, 0.003f);                   // half a code of sRGB at 188
  EXPECT_FLOAT_EQ(at(row(), 0.3f, kRepeat, false, 9), 102.0f / 255);      // the mean of the row, 0.4
  EXPECT_NEAR(at(row(), 0.25f, kClamp, false, 1), 0.1f, 0.51f / 255);     // (0 + 0.2) / 2 and half a code
  EXPECT_NEAR(at(row(), 0.25f, kClamp, false, 0.5f), 0.1f, 0.26f / 255);  // half way between levels
}

/// White where it is visible (alpha 1 and 1/3), green where it is hidden. The means of a cutout are white, and a
/// third of it is visible.
TEST(TexturePyramid, WhatACutoutHidesHasNoShareInItsMeans) {
  const std::vector<std::uint8_t> codes{255, 255, 255, 255, 0, 255, 0, 0, 0, 255, 0, 0, 255, 255, 255, 85};
  const TexturePyramid cutout{CodedPixels{2, 2, 4, 8, codes}, TextureTransfer::srgb_cutout};
  const TexturePyramid plain{CodedPixels{2, 2, 4, 8, codes}, TextureTransfer::srgb};
  EXPECT_EQ(cutout.texel(1, 0, 0)[0], 1);
  EXPECT_EQ(cutout.texel(1, 0, 0)[1], 1);
  EXPECT_NEAR(plain.texel(1, 0, 0)[0], 0.5f, 0.003f);
  EXPECT_FLOAT_EQ(cutout.texel(1, 0, 0)[3], plain.texel(1, 0, 0)[3]);
  EXPECT_FLOAT_EQ(cutout.texel(1, 0, 0)[3], 85.0f / 255);
  // All hidden: the plain mean.
  const TexturePyramid hidden{CodedPixels{2, 1, 2, 8, {0, 0, 255, 0}}, TextureTransfer::srgb_cutout};
  EXPECT_NEAR(hidden.texel(1, 0, 0)[0], 0.5f, 0.003f);
}

TEST(TexturePyramid, OddSizesKeepTheMean) {
  CodedPixels pixels{37, 11, 3, 8, {}};
  double mean = 0;
  for (int i = 0; i < 37 * 11 * 3; ++i) {
    const auto code = std::uint8_t(i * 7919 % 256);
    pixels.bytes.push_back(code);
    if (i % 3 == 1) mean += code / 255.0 / (37 * 11);
  }
  const TexturePyramid texture{pixels, TextureTransfer::linear};
  for (int level = 0; level < texture.level_count(); ++level) {
    double sum = 0;
    for (int y = 0; y < texture.height(level); ++y)
      for (int x = 0; x < texture.width(level); ++x) sum += texture.texel(level, x, y)[1];
    // Rounding to codes: at most half a code on each of up to six levels.
    EXPECT_NEAR(sum / (texture.width(level) * texture.height(level)), mean, 3 / 255.0) << level;
  }
  EXPECT_EQ(texture.width(texture.level_count() - 1), 1);
  EXPECT_EQ(texture.height(texture.level_count() - 1), 1);
}

/// In a smooth gradient half of the means lie half way between two codes. If they are always rounded up, and each level
/// is made from the rounded one before, the last of these levels is 3 % too bright.
TEST(TexturePyramid, AGradientKeepsItsMean) {
  for (const bool upright : {false, true}) {
    CodedPixels pixels{256, 256, 1, 8, {}};
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) pixels.bytes.push_back(std::uint8_t(20 + (upright ? y : x) / 3));
    const TexturePyramid texture{pixels, TextureTransfer::srgb};
    double mean = 0;
    for (int level = 0; texture.width(level) >= 16; ++level) {
      double sum = 0;
      for (int y = 0; y < texture.height(level); ++y)
        for (int x = 0; x < texture.width(level); ++x) sum += texture.texel(level, x, y)[0];
      sum /= texture.width(level) * texture.height(level);
      if (level == 0) mean = sum;
      EXPECT_NEAR(sum / mean, 1, 0.006) << level;  // 16 values, each with .3 codes of rounding: 2 deviations
    }
  }
}

TEST(TexturePyramid, ATexelIsBlackOnlyIfAllItCoversIs) {
  CodedPixels pixels{64, 64, 1, 8, std::vector<std::uint8_t>(64 * 64)};
  pixels.bytes[64 * 41 + 9] = 1;
  const TexturePyramid texture{pixels, TextureTransfer::srgb};
  EXPECT_GT(texture.texel(6, 0, 0)[0], 0);
  EXPECT_TRUE(texture.any_colour({0, 0}, {1, 1}, kRepeat, kRepeat));
  const float u = 9.5f / 64, v = 41.5f / 64;
  EXPECT_TRUE(texture.any_colour({u, v}, {u, v}, kRepeat, kRepeat));
  EXPECT_TRUE(texture.any_colour({u + 3, v - 2}, {u + 3.01f, v - 1.99f}, kRepeat, kRepeat));
  EXPECT_TRUE(texture.any_colour({0.1f, 0.5f}, {0.6f, 0.9f}, kClamp, kClamp));
  EXPECT_FALSE(texture.any_colour({0.5f, 0.1f}, {0.6f, 0.2f}, kRepeat, kRepeat));
  EXPECT_FALSE(texture.any_colour({0.4f, 0.0f}, {0.9f, 0.3f}, kClamp, kClamp));
}

TEST(TextureImages, NothingIsDecodedBeforeItIsLookedAt) {
  std::vector<EncodedImage> list{test::png_image(2, 2, 3, std::vector<std::uint8_t>(12, 128)),
                                 test::png_image(1, 1, 3, {1, 2, 3})};
  list[1].bytes.resize(40);  // damaged, but no one looks
  const TextureImages images(std::move(list));
  EXPECT_EQ(images.decoded_count(), 0u);
  const TexturePyramid& first = images.pyramid(0, TextureTransfer::srgb);
  EXPECT_EQ(&first, &images.pyramid(0, TextureTransfer::srgb));
  EXPECT_EQ(images.decoded_count(), 1u);
  EXPECT_EQ(images.decoded_bytes(), 15u);  // 4 texels and 1, three channels
  EXPECT_NE(message_of<InputError>([&] { images.pyramid(1, TextureTransfer::srgb); }).find("test.png"),
            std::string::npos);
}

TEST(TextureImages, LimitsOfBytesAndSide) {
  const auto make = [](const TextureLimits& limits) {
    return TextureImages({test::png_image(8, 8, 1, std::vector<std::uint8_t>(64, 9))}, limits);
  };
  const auto error = [&](const TextureLimits& limits) {
    return message_of<InputError>([&] { make(limits).pyramid(0, TextureTransfer::linear); });
  };
  EXPECT_EQ(error({.max_bytes = 85}), "");
  EXPECT_NE(error({.max_bytes = 84}).find("--max-memory"), std::string::npos);  // 64 + 16 + 4 + 1 bytes
  EXPECT_NE(error({.max_pixels = 63}).find("limit of 63"), std::string::npos);
}

}  // namespace
}  // namespace tempolux
