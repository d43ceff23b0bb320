// Which neighbours' surfaces a pixel sees: an edge at known positions in pixels.
#include "lib/render/data_channels.h"

#include <gtest/gtest.h>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

/// A sheet at z = 0 left of x = `edge` (in pixels of from_above()), and another below it at z = -1.
Image frame_of_step(float edge, float bottom = 100) {
  test::HandMadeScene made;
  const float x = edge / 32 - 1, y = 0.5625f - bottom / 32;
  made.add({{-2, y, 0}, {x, y, 0}, {x, 2, 0}, {-2, 2, 0}, {-3, -3, -1}, {3, -3, -1}, {3, 3, -1}, {-3, 3, -1}},
           {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}, test::matte(Rgb(0.5f)));
  made.add_point_light({0, 0, 3}, Rgb(1.0f));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const CameraView view = test::from_above();
  Image image{64, 36, {}, {}, {}, {}};
  add_data_channels({tracer, lights}, view, {"Z", "N", "id"}, {}, {}, image);
  add_coverage_channel({tracer, lights}, view, {"coverage"}, image);
  return image;
}

std::uint32_t coverage_at(const Image& image, int x, int y) {
  return image.find("coverage")->ids[std::size_t(y * 64 + x)];
}

/// Sixteen stratified points put one point in each sixteenth of the pixel's width: a quarter is four of them.
TEST(Coverage, OfAStraightEdgeIsItsShare) {
  const Image right =
      // The centre of column 32 sees the lower sheet; a quarter of the pixel shows the upper one, which its left
      // neighbour sees.
      frame_of_step(32.25f);
  // Now the centre sees the upper sheet, and a quarter shows the sheet that column 33 sees.
  const Image left = frame_of_step(32.75f);
  for (int y = 1; y < 35; ++y) {
    EXPECT_EQ(coverage_at(right, 32, y), 4u << 12);
    EXPECT_EQ(coverage_at(left, 32, y), 4u << 16);
    for (const int x : {0, 30, 31, 33, 34, 63}) EXPECT_EQ(coverage_at(right, x, y), 0u) << x;
  }
}

/// The sheet's corner covers a quarter of pixel (32, 20), whose centre misses it: only the upper left neighbours see
/// the sheet. Points are stratified in quarters of the pixel, too.
TEST(Coverage, OfACornerGoesToTheNearestPixelThatSeesIt) {
  const Image image = frame_of_step(32.5f - 1 / 64.0f, 20.5f - 1 / 64.0f);
  const std::uint32_t packed = coverage_at(image, 32, 20);
  std::uint32_t sum = 0;
  for (int n = 0; n < 8; ++n) sum += packed >> (4 * n) & 15;
  EXPECT_GE(sum, 3u);
  EXPECT_LE(sum, 4u);
  // No rays for the neighbours at the lower left, below, at the lower right and at the right.
  EXPECT_EQ(packed & 0xfff00000u, 0u);
  EXPECT_EQ(packed >> 16 & 15, 0u);
}

/// Two strips with half a pixel's width lie between pixel centres, so no centre sees them. One is a part of the mesh
/// behind. Their quarter of both neighbouring pixels counts as other.
TEST(Coverage, WhatNoCentreSeesIsOther) {
  test::HandMadeScene made;
  const float left = 0.75f / 32, right = 1.25f / 32;
  made.add(
      {{left, -2, 0}, {right, -2, 0}, {right, 2, 0}, {left, 2, 0}, {-3, -3, -1}, {3, -3, -1}, {3, 3, -1}, {-3, 3, -1}},
      {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}, test::matte(Rgb(0.5f)));
  made.add({{left, -2, 0.1f}, {right, -2, 0.1f}, {right, 0, 0.1f}, {left, 0, 0.1f}}, {{0, 1, 2}, {0, 2, 3}},
           test::matte(Rgb(0.1f)));
  made.add_point_light({0, 0, 3}, Rgb(1.0f));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  Image image{64, 36, {}, {}, {}, {}};
  add_coverage_channel({tracer, lights}, test::from_above(), {"coverage"}, image);
  for (const std::size_t row : {std::size_t(10), std::size_t(30)}) {
    for (const std::size_t x : {32, 33}) EXPECT_EQ(image.find("coverage.other")->ids[row * 64 + x], 4u) << x;
    for (const std::size_t x : {31, 34, 40}) EXPECT_EQ(image.find("coverage.other")->ids[row * 64 + x], 0u) << x;
  }
}

/// Two materials in one plane are two surfaces: the pixel between them is composed of both.
TEST(Coverage, MaterialsOfOneMeshAreToldApart) {
  test::HandMadeScene made;
  const float x = 0.25f / 32;
  made.add({{-2, -2, 0}, {x, -2, 0}, {x, 2, 0}, {-2, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}, test::matte(Rgb(0.5f)));
  made.add({{x, -2, 0}, {2, -2, 0}, {2, 2, 0}, {x, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}, test::matte(Rgb(0.1f)));
  made.add_point_light({0, 0, 3}, Rgb(1.0f));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  Image image{64, 36, {}, {}, {}, {}};
  add_coverage_channel({tracer, lights}, test::from_above(), {"RGBA"}, image);
  EXPECT_TRUE(image.channels.empty());
  add_coverage_channel({tracer, lights}, test::from_above(), {"coverage"}, image);
  EXPECT_EQ(coverage_at(image, 32, 18), 4u << 12);
  EXPECT_EQ(coverage_at(image, 31, 18), 0u);
}

}  // namespace
}  // namespace tempolux
