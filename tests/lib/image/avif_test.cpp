// AVIF in memory: sizes by the boxes of its container, pixels as coded, damage and hostile lengths refused.
#include <gtest/gtest.h>

#include <chrono>
#include <string_view>

#include "formats/error.h"
#include "lib/image/avif_header.h"
#include "lib/image/encoded_image.h"
#include "tests/lib/image/image_fixture.h"
#include "tests/support/packers.h"

namespace tempolux {
namespace {

using test::avif_bytes;
using namespace std::string_literals;

std::span<const unsigned char> bytes_of(std::string_view text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}
EncodedImage encoded(std::string_view bytes) { return {"x.avif", {bytes.begin(), bytes.end()}, 0, 0, ""}; }
CodedPixels decoded(std::string_view bytes) { return decode_image(encoded(bytes), 1 << 20); }
std::string error_of(std::string_view bytes, std::uint64_t max_pixels = 1 << 20) {
  return message_of<InputError>([&] { decode_image(encoded(bytes), max_pixels); });
}
void expect_error(std::string_view bytes, std::string_view part) {
  EXPECT_NE(error_of(bytes).find(part), std::string::npos) << error_of(bytes);
}

/// 24 x 10 pixels that differ in all channels.
constexpr int kWidth = 24, kHeight = 10;
std::vector<std::uint8_t> codes_of(int channels, int alpha = -1) {
  std::vector<std::uint8_t> codes;
  for (int i = 0; i < kWidth * kHeight; ++i)
    for (int c = 0; c < channels; ++c)
      codes.push_back(std::uint8_t(c == 3 && alpha >= 0 ? alpha : (17 * i + 80 * c * (i % 3) + 31 * c) % 256));
  return codes;
}

// ---- a container by hand ----

std::string number(std::uint64_t value, int byte_count) {
  std::string text;
  for (int i = byte_count - 1; i >= 0; --i) text += char(value >> (8 * i) & 255);
  return text;
}
std::string box(const std::string& type, const std::string& content) {
  return number(8 + content.size(), 4) + type + content;
}
std::string long_box(const std::string& type, const std::string& content) {
  return number(1, 4) + type + number(16 + content.size(), 8) + content;
}
std::string ispe(std::uint32_t width, std::uint32_t height) {
  return box("ispe", number(0, 4) + number(width, 4) + number(height, 4));
}
const std::string kType = box("ftyp", "mif1"s + number(0, 4) + "mif1avif"s);
/// An AVIF whose primary item is `item`, with these properties and associations.
std::string container(const std::string& pitm, const std::string& properties, const std::string& associations) {
  return kType + box("free", "xx") +
         box("meta", number(0, 4) + pitm + box("iprp", box("ipco", properties) + associations));
}

TEST(Avif, ThePrimaryImagesSizeCounts) {
  const std::string properties = ispe(1, 1) + box("pixi", "abc") + ispe(7, 5);
  const auto read = [](const std::string& file) { return read_avif_header(bytes_of(file)); };
  // item 1 has property 1; item 2 has 2 and, as an essential one, 3
  const std::string associations =
      box("ipma", number(0, 4) + number(2, 4) + number(1, 2) + "\1\1"s + number(2, 2) + "\2\2"s + char(0x83));
  auto header = read(container(box("pitm", number(0, 4) + number(2, 2)), properties, associations));
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->width, 7);
  EXPECT_EQ(header->height, 5);
  EXPECT_FALSE(header->is_transformed);
  EXPECT_FALSE(read(container(box("pitm", number(0, 4) + number(3, 2)), properties, associations)).has_value());
  // Wide item numbers, wide property numbers, 64-bit lengths.
  const std::string wide =
      long_box("ipma", number(0x01000001, 4) + number(1, 4) + number(70000, 4) + "\1"s + "\x80\3"s);
  header = read(container(long_box("pitm", number(0x01000000, 4) + number(70000, 4)), properties, wide));
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->width, 7);
  const ImageHeader whole =
      read_image_header(bytes_of(container(box("pitm", number(0, 4) + number(1, 2)), properties, associations)), "x");
  EXPECT_EQ(whole.format, ImageHeader::Format::avif);
  EXPECT_EQ(whole.width, 1);
}

TEST(Avif, HostileLengthsEndAtOnce) {
  const std::string pitm = box("pitm", number(0, 4) + number(1, 2));
  const std::string one = box("ipma", number(0, 4) + number(1, 4) + number(1, 2) + "\1\1"s);
  const auto expect_refused = [](const std::string& file) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_FALSE(read_avif_header(bytes_of(file)).has_value());
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  };
  ASSERT_TRUE(read_avif_header(bytes_of(container(pitm, ispe(1, 1), one))).has_value());
  expect_refused(container(pitm, ispe(0xffffffffu, 1), one));
  expect_refused(container(pitm, box("ispe", number(0, 4) + number(1, 4)), one));
  expect_refused(container(pitm, ispe(1, 1), box("ipma", number(0, 4) + number(0xffffffffu, 4))));  // entries
  expect_refused(container(pitm, ispe(1, 1), box("ipma", number(0, 4) + number(1, 4) + number(1, 2) + "\xff\1"s)));
  expect_refused(container(pitm, number(7, 4) + "ispe" + ispe(1, 1), one));  // shorter than its own head
  expect_refused(container(pitm, number(0xffffffffu, 4) + "free" + ispe(1, 1), one));
  expect_refused(container(pitm, number(1, 4) + "free" + number(~0ull, 8) + ispe(1, 1), one));
  expect_refused(kType + number(1, 4) + "meta" + number(~0ull - 2, 8));
  expect_refused(kType + number(0, 4) + "meta");
  // A million properties and a million lists of associations.
  std::string many, lists;
  for (int i = 0; i < 1'000'000; ++i) many += box("ispe", ""), lists += box("ipma", number(0, 4) + number(0, 4));
  expect_refused(container(pitm, many, lists));
}

TEST(Avif, OtherBrandsAreRefused) {
  std::string heic = avif_bytes(2, 2, 3, std::vector<std::uint8_t>(12));
  for (std::size_t at = 8; at < 40; ++at)
    if (heic.substr(at, 4) == "avif") heic.replace(at, 4, "heic");
  expect_error(heic, "x.avif: is HEIC, MP4 or a damaged AVIF; textures must be PNG, JPEG, WebP or AVIF: convert it");
  expect_error("\xff\xff\xff\xff"s + "ftypavif" + number(0, 4) + "avif", "a damaged AVIF");
}

// ---- pixels ----

TEST(Avif, WithoutLossTheCodesAreKept) {
  for (const int channels : {3, 4}) {
    const std::vector<std::uint8_t> codes = codes_of(channels);
    const CodedPixels pixels = decoded(avif_bytes(kWidth, kHeight, channels, codes));
    EXPECT_EQ(pixels.width, kWidth);
    EXPECT_EQ(pixels.height, kHeight);
    ASSERT_EQ(pixels.channels, 4);
    ASSERT_EQ(pixels.bytes.size(), std::size_t(4 * kWidth * kHeight));
    for (std::size_t i = 0; i < pixels.bytes.size(); ++i) {
      const std::size_t c = i % 4;
      EXPECT_EQ(pixels.bytes[i], c == 3 && channels == 3 ? 255 : codes[i / 4 * std::size_t(channels) + c]) << i;
    }
  }
}

// Brightness and two differences of colour are rounded once each: R = Y + 1.402 Cr and B = Y + 1.772 Cb err by half a
// step of each number and of their own, 1.9 codes at most. Another matrix (BT.709) would err by more than 10.
TEST(Avif, ColoursAreWithinTheEncodersRounding) {
  const std::vector<std::uint8_t> codes = codes_of(4);
  for (const int depth : {8, 10, 12}) {
    const CodedPixels pixels = decoded(avif_bytes(kWidth, kHeight, 4, codes, {.as_rgb = false, .depth = depth}));
    ASSERT_EQ(pixels.bytes.size(), codes.size());
    for (std::size_t i = 0; i < codes.size(); ++i) EXPECT_NEAR(pixels.bytes[i], codes[i], i % 4 == 3 ? 0 : 2) << depth;
  }
}

// Colours times alpha are rounded to steps of 1: divided by an alpha of 128/255, they err by a step more.
TEST(Avif, MultipliedColoursAreDividedByAlpha) {
  const std::vector<std::uint8_t> codes = codes_of(4, 128);
  const CodedPixels pixels = decoded(avif_bytes(kWidth, kHeight, 4, codes, {.premultiplied = true}));
  ASSERT_EQ(pixels.bytes.size(), codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) EXPECT_NEAR(pixels.bytes[i], codes[i], i % 4 == 3 ? 0 : 2);
}

TEST(Avif, WhatViewersWouldTurnOrPlayIsRefused) {
  const std::vector<std::uint8_t> codes = codes_of(3);
  EXPECT_EQ(error_of(avif_bytes(kWidth, kHeight, 3, codes, {.quarter_turns = 0})), "");
  expect_error(avif_bytes(kWidth, kHeight, 3, codes, {.quarter_turns = 1}),
               "x.avif: the AVIF is turned, mirrored or cropped when it is shown; save it as it is shown");
  expect_error(avif_bytes(kWidth, kHeight, 3, codes, {.mirrored = true}), "is turned, mirrored or cropped");
  expect_error(avif_bytes(kWidth, kHeight, 3, codes, {.frames = 2}),
               "tempolux-decode finds an animated AVIF: a texture must be one picture; convert it to PNG or JPEG");
}

TEST(Avif, WhatIsTooLargeIsRefusedBeforeItIsDecoded) {
  std::string file = avif_bytes(2, 2, 3, std::vector<std::uint8_t>(12));
  const std::size_t at = file.find("ispe");
  ASSERT_NE(at, std::string::npos);
  file.replace(at + 8, 8, number(60000, 4) + number(50000, 4));
  EXPECT_NE(error_of(file).find("60000x50000 pixels, over the limit of 1048576"), std::string::npos);
}

TEST(Avif, EveryTruncationIsRefused) {
  const std::string whole = avif_bytes(4, 4, 4, std::vector<std::uint8_t>(64, 100));
  EXPECT_EQ(error_of(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string error = error_of(whole.substr(0, size));
    EXPECT_NE(error, "") << size;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(Avif, ChangedBytesNeverCrash) {
  const std::string whole = avif_bytes(4, 4, 4, std::vector<std::uint8_t>(64, 100));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ 0x55);
    EXPECT_EQ(error_of(bytes).find("died"), std::string::npos) << at << error_of(bytes);  // an error, or other pixels
  }
}

}  // namespace
}  // namespace tempolux
