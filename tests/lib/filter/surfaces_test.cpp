// Which pixels lie on one surface: planes at any slant, steps of depth, other objects, normals that turn.
#include "lib/filter/surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/filter/surface_weight.h"

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

/// True if pixel (x, y) and the pixel at offset (dx, dy) show one surface, as seen from the first.
bool same(const Surfaces& surfaces, int x, int y, int dx, int dy) {
  return SurfaceEight(surfaces, y, dy, x).surface(dx)[0] != 0;
}

/// For each pixel, 1 unless it and each of its eight neighbours show one surface, as seen from either.
std::vector<std::uint8_t> edges_of(const Surfaces& surfaces) {
  std::vector<std::uint8_t> edge;
  for (int y = 0; y < surfaces.height; ++y)
    for (int x = 0; x < surfaces.width; ++x) {
      edge.push_back(0);
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (surfaces.has_pixel(x + i, y + j) && !(same(surfaces, x, y, i, j) && same(surfaces, x + i, y + j, -i, -j)))
            edge.back() = 1;
    }
  return edge;
}

/// A floor that reaches to the horizon. 1/Z is linear in lines, so at its far end depth doubles from line to line;
/// still it is one surface.
TEST(Surfaces, APlaneIsOneSurfaceHoweverGrazing) {
  const Surfaces surfaces(picture(16, 64, [](int, int y) { return 10.0f / float(y + 1); }), false);
  for (const std::uint8_t edge : edges_of(surfaces)) EXPECT_EQ(edge, 0);
  EXPECT_TRUE(same(surfaces, 8, 8, 0, 5));
}

TEST(Surfaces, AStepOfDepthIsAnEdgeWithinOneObject) {
  const Surfaces surfaces(picture(16, 16, [](int x, int) { return x < 8 ? 2.0f : 2.1f; }), false);
  const auto edges = edges_of(surfaces);
  for (std::size_t p = 0; p < edges.size(); ++p) EXPECT_EQ(edges[p], p % 16 == 7 || p % 16 == 8);
}

TEST(Surfaces, ObjectsAndNormalsSeparate) {
  Image image = picture(8, 8, [](int, int) { return 1.0f; });
  image.find("id.object")->ids[3 * 8 + 3] = 7;
  image.find("N.Z")->values[5 * 8 + 5] = std::cos(0.5f);  // 29 degrees; 26 are allowed
  image.find("N.X")->values[5 * 8 + 5] = std::sin(0.5f);
  const Surfaces surfaces(image, false);
  EXPECT_FALSE(same(surfaces, 2, 3, 1, 0));
  EXPECT_FALSE(same(surfaces, 4, 5, 1, 0));
  EXPECT_TRUE(same(surfaces, 0, 0, 1, 1));
}

/// A picture that has only colour is one surface. Depths of 0, infinity, NaN or below 0 lead to no result that is not
/// a finite number.
TEST(Surfaces, WhatIsNotKnownAgrees) {
  const Surfaces none(Image{4, 4, {}, {}, {}, {}}, false);
  for (const std::uint8_t edge : edges_of(none)) EXPECT_EQ(edge, 0);
  const float odd[] = {0, INFINITY, -1, NAN, 1e-38f, 1e10f};
  const Surfaces strange(picture(6, 1, [&](int x, int) { return odd[x]; }), false);
  for (int x = 0; x < 6; ++x) EXPECT_TRUE(std::isfinite(strange.w.at(x, 0)) && std::isfinite(strange.w_right.at(x, 0)));
  EXPECT_TRUE(same(strange, 0, 0, 1, 0));
  EXPECT_EQ(edges_of(Surfaces(picture(1, 1, [](int, int) { return 1.0f; }), false))[0], 0);
}

}  // namespace
}  // namespace tempolux
