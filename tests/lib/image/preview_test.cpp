// Previews: the tone curve's values, auto exposure, what each kind of layer looks like, contact sheets, PNG.
#include "lib/image/preview.h"

#include <cmath>

#include "formats/error.h"
#include "lib/image/png_io.h"
#include "lib/image/srgb.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

Image row(std::vector<std::pair<std::string, std::vector<float>>> channels) {
  Image image;
  image.width = int(channels[0].second.size());
  image.height = 1;
  for (auto& [name, values] : channels) image.add(name).values = values;
  return image;
}
Image grey_row(const std::vector<float>& values) { return row({{"R", values}, {"G", values}, {"B", values}}); }

std::vector<int> pixel(const Picture& picture, int x, int y = 0) {
  const std::uint8_t* p = picture.rgb.data() + 3 * (y * picture.width + x);
  return {p[0], p[1], p[2]};
}

TEST(Preview, ToneCurveIsSrgb) {
  // Of IEC 61966-2-1: 0.0031308 * 12.92 * 255 = 10.31; (1.055 * 0.18^(1/2.4) - 0.055) * 255 = 117.6;
  // (1.055 * 0.5^(1/2.4) - 0.055) * 255 = 187.5 -> 188; above 1 is clipped.
  const Picture picture = make_picture(grey_row({0, 0.0031308f, 0.18f, 0.5f, 1, 7}), {"", 0.0});
  const int expected[] = {0, 10, 118, 188, 255, 255};
  for (int x = 0; x < 6; ++x) EXPECT_EQ(pixel(picture, x), std::vector<int>(3, expected[x])) << x;
  // One stop more is twice the light.
  EXPECT_EQ(pixel(make_picture(grey_row({0.25f}), {"", 1.0}), 0), std::vector<int>(3, 188));
}

TEST(Preview, SrgbTransferInvertsItself) {
  for (int code = 0; code < 256; ++code)
    EXPECT_EQ(std::lround(255 * linear_to_srgb(srgb_to_linear(float(code) / 255))), code);
}

TEST(Preview, AutoExposureMapsThe98thPercentileTo09) {
  std::vector<float> values(100);
  for (int i = 0; i < 100; ++i) values[(i * 37) % 100] = float(i + 1);  // 1 .. 100, shuffled: rank 98 is 98
  Image image = grey_row(values);
  EXPECT_NEAR(auto_exposure_stops(image, ""), std::log2(0.9 / 98), 1e-6);
  // Luminance, not a channel: green only.
  for (const char* name : {"R", "B"}) image.find(name)->values.assign(100, 0.0f);
  EXPECT_NEAR(auto_exposure_stops(image, ""), std::log2(0.9 / (98 * 0.7152)), 1e-6);
  // A lamp in black: fewer than 2 % of the pixels are lit.
  std::vector<float> lamp(100);
  lamp[5] = 4;
  EXPECT_NEAR(auto_exposure_stops(grey_row(lamp), ""), std::log2(0.9 / 4), 1e-6);
  EXPECT_EQ(auto_exposure_stops(grey_row({0, 0}), ""), 0);
  EXPECT_EQ(auto_exposure_stops(row({{"Z", {1, 2}}}), "Z"), 0);
}

TEST(Preview, SignedLayersAreGreyRedAndBlue) {
  // The largest component decides: if red rises and green falls by less, the pixel counts as "above".
  const Picture picture =
      make_picture(row({{"d.R", {0, 1, 0, 0.5f}}, {"d.G", {0, 0, -1, -0.25f}}, {"d.B", {0, 0, 0, 0}}}), {"d", 0.0});
  EXPECT_EQ(pixel(picture, 0), (std::vector<int>{128, 128, 128}));
  EXPECT_EQ(pixel(picture, 1), (std::vector<int>{255, 51, 0}));
  EXPECT_EQ(pixel(picture, 2), (std::vector<int>{0, 64, 255}));
  EXPECT_GT(pixel(picture, 3)[0], 200);
  EXPECT_LT(pixel(picture, 3)[2], 60);
}

/// Light with a rounding error below 0, or with the negative lobe of a sharp filter (1 % of it), is shown as light:
/// .5 is code 188, and values below 0 are black. As a difference .5 would be red.
TEST(Preview, LightWithALittleBelowZeroIsLight) {
  for (const float below : {-1e-11f, -0.015f}) {
    const Picture picture = make_picture(grey_row({0.5f, below, 1}), {"", 0.0});
    EXPECT_EQ(pixel(picture, 0), (std::vector<int>(3, 188))) << below;
    EXPECT_EQ(pixel(picture, 1), (std::vector<int>(3, 0))) << below;
    EXPECT_NEAR(auto_exposure_stops(grey_row({0.5f, below, 1}), ""), std::log2(0.9), 1e-6);
  }
  // 3 % of it is a difference.
  EXPECT_EQ(pixel(make_picture(grey_row({0.5f, -0.05f, 1}), {"", 0.0}), 2), (std::vector<int>{255, 51, 0}));
}

TEST(Preview, DepthIsBrightNearDarkFarAndBlackForNothing) {
  const Picture picture = make_picture(row({{"Z", {1, 2, 3, INFINITY, 1e10f}}}), {"Z", {}});
  EXPECT_EQ(pixel(picture, 0)[0], 255);
  EXPECT_EQ(pixel(picture, 1)[0], 140);  // 0.55
  EXPECT_EQ(pixel(picture, 2)[0], 26);   // 0.1
  EXPECT_EQ(pixel(picture, 3)[0], 0);
  EXPECT_EQ(pixel(picture, 4)[0], 0);
}

TEST(Preview, NormalsPositionsMotionAndIds) {
  Image image = row({{"N.X", {1, -1, 0}},
                     {"N.Y", {0, 0, 1}},
                     {"N.Z", {0, 0, 0}},
                     {"P.X", {-5, 0, 5}},
                     {"P.Y", {2, 2, 2}},
                     {"P.Z", {0, 10, 5}},
                     {"forward.u", {0, 4, -4}},
                     {"forward.v", {0, 0, 2}}});
  image.add_ids("id.object").ids = {0, 0xffffffffu, 1};
  const Picture normal = make_picture(image, {"N", {}});
  EXPECT_EQ(pixel(normal, 0), (std::vector<int>{255, 128, 128}));
  EXPECT_EQ(pixel(normal, 1), (std::vector<int>{0, 128, 128}));
  EXPECT_EQ(pixel(normal, 2), (std::vector<int>{128, 255, 128}));
  EXPECT_EQ(pixel(make_picture(image, {"P", {}}), 1), (std::vector<int>{128, 128, 255}));
  const Picture motion = make_picture(image, {"forward", -2.0});  // 4 pixels: full
  EXPECT_EQ(pixel(motion, 0), (std::vector<int>{128, 128, 128}));
  EXPECT_EQ(pixel(motion, 1), (std::vector<int>{255, 128, 128}));
  EXPECT_EQ(pixel(motion, 2), (std::vector<int>{0, 191, 128}));
  const Picture ids = make_picture(image, {"id.object", {}});
  EXPECT_EQ(pixel(ids, 1), (std::vector<int>{0, 0, 0}));
  EXPECT_NE(pixel(ids, 0), pixel(ids, 2));
  EXPECT_GE(pixel(ids, 0)[0], 63);
  const std::string message = message_of<InputError>([&] { make_picture(image, {"direct", {}}); });
  EXPECT_NE(message.find("\"direct\"; the image has N.X"), std::string::npos) << message;
}

Picture plain(int width, int height, std::uint8_t grey) {
  return {width, height, std::vector<std::uint8_t>(std::size_t(3 * width * height), grey)};
}

TEST(ContactSheet, CellsGapsAndColumns) {
  const std::vector<Picture> five(5, plain(10, 6, 200));
  Picture sheet = contact_sheet(five, 0, 100);  // about square: 3 x 2
  EXPECT_EQ(sheet.width, 3 * 10 + 2 * 2);
  EXPECT_EQ(sheet.height, 2 * 6 + 2);
  EXPECT_EQ(pixel(sheet, 9, 5)[0], 200);
  EXPECT_EQ(pixel(sheet, 10, 0)[0], 0);
  EXPECT_EQ(pixel(sheet, 11, 0)[0], 0);
  EXPECT_EQ(pixel(sheet, 12, 0)[0], 200);
  EXPECT_EQ(pixel(sheet, 0, 7)[0], 0);
  EXPECT_EQ(pixel(sheet, 0, 8)[0], 200);
  EXPECT_EQ(pixel(sheet, 24, 8)[0], 0);  // the sixth cell is empty
  sheet = contact_sheet(five, 5, 100);
  EXPECT_EQ(sheet.width, 58);
  EXPECT_EQ(sheet.height, 6);
  EXPECT_THROW(contact_sheet({}, 0, 100), std::invalid_argument);
}

TEST(ContactSheet, AMarkIsABorder) {
  Picture picture = plain(120, 40, 200);  // 120 / 40 = 3 pixels
  mark(picture);
  for (const auto& [x, y] : {std::pair{0, 0}, {2, 20}, {60, 2}, {119, 39}, {117, 20}, {60, 37}})
    EXPECT_EQ(pixel(picture, x, y), (std::vector<int>{255, 176, 0})) << x << " " << y;
  for (const auto& [x, y] : {std::pair{3, 3}, {60, 20}, {116, 36}})
    EXPECT_EQ(pixel(picture, x, y), (std::vector<int>{200, 200, 200})) << x << " " << y;
}

TEST(ContactSheet, ShrinkingAveragesLight) {
  Picture stripes = plain(6, 4, 0);  // white and black columns
  for (std::size_t i = 0; i < stripes.rgb.size(); ++i)
    if (i / 3 % 2 == 0) stripes.rgb[i] = 255;
  const Picture small = contact_sheet({stripes}, 1, 3);
  EXPECT_EQ(small.width, 3);
  EXPECT_EQ(small.height, 2);
  for (int x = 0; x < 3; ++x)
    EXPECT_EQ(pixel(small, x), std::vector<int>(3, 188));  // half the light, not half the code
  // 6 to 4: a pixel covers 1.5; the first is one white and half a black column: 2/3 of the light,
  // (1.055 * 0.6667^(1/2.4) - 0.055) * 255 = 213.2.
  EXPECT_EQ(pixel(contact_sheet({stripes}, 1, 4), 0)[0], 213);
  EXPECT_EQ(contact_sheet({plain(8, 8, 77)}, 1, 3).rgb, std::vector<std::uint8_t>(27, 77));
}

TEST(Png, WhatIsSavedComesBack) {
  const Folder folder;
  Picture picture = plain(17, 9, 0);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] = std::uint8_t(i * 7);
  save_png(folder / "a.png", picture);
  const Image image = load_png(folder / "a.png", 1000);
  ASSERT_EQ(image.width, 17);
  ASSERT_EQ(image.height, 9);
  EXPECT_EQ(make_picture(image, {"", 0.0}).rgb, picture.rgb);
  EXPECT_NE(image.text.at("tempolux:source").find("8 bits, sRGB"), std::string::npos);
  save_png(folder / "b.png", picture);
  EXPECT_EQ(bytes_of(folder / "a.png"), bytes_of(folder / "b.png"));
  EXPECT_THROW(save_png("/dev/full", picture), ResourceError);
  EXPECT_THROW(load_png(folder / "a.png", 17 * 9 - 1), InputError);
}

}  // namespace
}  // namespace tempolux
