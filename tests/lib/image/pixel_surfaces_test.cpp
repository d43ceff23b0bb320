// Which pixels lie on one surface: planes at any slant, steps of depth, other objects, normals that turn.
#include "lib/image/pixel_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

/// For each pixel, 1 unless it and each of its eight neighbours show one surface, in both directions of same().
std::vector<std::uint8_t> edges_of(const PixelSurfaces& surfaces) {
  const int width = surfaces.width(), height = surfaces.height();
  std::vector<std::uint8_t> edge(surfaces.w.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int j = std::max(-1, -y); j <= std::min(1, height - 1 - y); ++j)
        for (int i = std::max(-1, -x); i <= std::min(1, width - 1 - x); ++i) {
          const auto p = std::size_t(y * width + x), q = std::size_t((y + j) * width + x + i);
          if ((i != 0 || j != 0) && !(surfaces.same(p, i, j) && surfaces.same(q, -i, -j))) edge[p] = 1;
        }
  return edge;
}

/// A floor that reaches to the horizon. 1/Z is linear in lines, so at its far end depth doubles from line to line;
/// still it is one surface.
TEST(PixelSurfaces, APlaneIsOneSurfaceHoweverGrazing) {
  const PixelSurfaces surfaces(picture(16, 64, [](int, int y) { return 10.0f / float(y + 1); }));
  for (const std::uint8_t edge : edges_of(surfaces)) EXPECT_EQ(edge, 0);
  EXPECT_TRUE(surfaces.same(8 * 16 + 8, 0, 5));
}

TEST(PixelSurfaces, AStepOfDepthIsAnEdgeWithinOneObject) {
  const PixelSurfaces surfaces(picture(16, 16, [](int x, int) { return x < 8 ? 2.0f : 2.1f; }));
  const auto edges = edges_of(surfaces);
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
  for (const std::uint8_t edge : edges_of(none)) EXPECT_EQ(edge, 0);
  const float odd[] = {0, INFINITY, -1, NAN, 1e-38f, 1e10f};
  const PixelSurfaces strange(picture(6, 1, [&](int x, int) { return odd[x]; }));
  for (std::size_t p = 0; p < 6; ++p) EXPECT_TRUE(std::isfinite(strange.w[p]) && std::isfinite(strange.w_right[p]));
  EXPECT_TRUE(strange.same(0, 1, 0));
  EXPECT_EQ(edges_of(PixelSurfaces(picture(1, 1, [](int, int) { return 1.0f; })))[0], 0);
}

}  // namespace
}  // namespace tempolux
