// Which pixels lie on one surface: planes at any slant, steps of depth, other objects, normals that turn.
#include "lib/image/pixel_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux {
namespace {

/// A picture whose pixel (x, y) is at depth z(x, y), one object, normals towards the camera.
template <class Depth>
Image picture(int width, int height, const Depth& z) {
  Image image{width, height, {}, {}, {}, {}};
  image.add("Z");
  for (const char* n : {"N.X", "N.Y", "N.Z"}) image.add(n);
  image.add_ids("id.object");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto p = std::size_t(y * width + x);
      image.channels[0].values[p] = z(x, y);
      image.channels[3].values[p] = 1;
    }
  return image;
}

/// A floor that reaches to the horizon. 1/Z is linear in lines, so at its far end depth doubles from line to line;
/// still it is one surface.
TEST(PixelSurfaces, APlaneIsOneSurfaceHoweverGrazing) {
  const PixelSurfaces surfaces(picture(16, 64, [](int, int y) { return 10.0f / float(y + 1); }));
  for (const std::uint8_t edge : surfaces.edges()) EXPECT_EQ(edge, 0);
  EXPECT_TRUE(surfaces.same(8 * 16 + 8, 0, 5));
}

TEST(PixelSurfaces, AStepOfDepthIsAnEdgeWithinOneObject) {
  const PixelSurfaces surfaces(picture(16, 16, [](int x, int) { return x < 8 ? 2.0f : 2.1f; }));
  const auto edges = surfaces.edges();
  for (std::size_t p = 0; p < edges.size(); ++p) EXPECT_EQ(edges[p], p % 16 == 7 || p % 16 == 8);
}

TEST(PixelSurfaces, ObjectsAndNormalsSeparate) {
  Image image = picture(8, 8, [](int, int) { return 1.0f; });
  image.find("id.object")->ids[3 * 8 + 3] = 7;
  image.find("N.Z")->values[5 * 8 + 5] = std::cos(0.5f);  // 29 degrees; 26 are allowed
  image.find("N.X")->values[5 * 8 + 5] = std::sin(0.5f);
  const PixelSurfaces surfaces(image);
  EXPECT_FALSE(surfaces.same(3 * 8 + 2, 1, 0));
  EXPECT_FALSE(surfaces.same(5 * 8 + 4, 1, 0));
  EXPECT_TRUE(surfaces.same(0, 1, 1));
}

/// A picture that has only colour is one surface. Depths of 0, infinity, NaN or below 0 lead to no result that is not
/// a finite number.
TEST(PixelSurfaces, WhatIsNotKnownAgrees) {
  const PixelSurfaces none(Image{4, 4, {}, {}, {}, {}});
  for (const std::uint8_t edge : none.edges()) EXPECT_EQ(edge, 0);
  const float odd[] = {0, INFINITY, -1, NAN, 1e-38f, 1e10f};
  const PixelSurfaces strange(picture(6, 1, [&](int x, int) { return odd[x]; }));
  for (std::size_t p = 0; p < 6; ++p) EXPECT_TRUE(std::isfinite(strange.w[p]) && std::isfinite(strange.w_right[p]));
  EXPECT_TRUE(strange.same(0, 1, 0));
  EXPECT_EQ(PixelSurfaces(picture(1, 1, [](int, int) { return 1.0f; })).edges()[0], 0);
}

}  // namespace
}  // namespace tempolux
