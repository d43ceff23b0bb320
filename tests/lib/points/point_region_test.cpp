// Points where cameras look: large triangles are cut along the spheres, small ones are taken as a whole, and points are
// uniform by area.
#include "lib/points/point_region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "lib/points/irradiance_points.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

/// A square of 2 km at y = 0 and, 3 m above its middle, one of 20 cm.
struct Plain {
  HandMadeScene scene;
  Plain() {
    scene.add_quad({-1000, 0, 1000}, {1000, 0, 1000}, {1000, 0, -1000}, {-1000, 0, -1000}, matte(Rgb(0.5f)));
    scene.add_quad({-0.1f, 3, 0.1f}, {0.1f, 3, 0.1f}, {0.1f, 3, -0.1f}, {-0.1f, 3, -0.1f}, matte(Rgb(0.5f)));
  }
};

double area_of(const std::vector<TrianglePiece>& pieces) {
  double sum = 0;
  for (const TrianglePiece& piece : pieces) sum += piece.area;
  return sum;
}

/// A sphere of 2 m around a place of the ground covers 4 pi m^2. A right-angled piece with a longest side of at most
/// half a metre counts if its middle lies in the sphere. The outline deviates by less than the distance between a
/// piece's middle and its corners (.37 m), and by much less in the mean. A piece is at least half of the largest one,
/// 1/32 m^2, so there are at most (2.4 m)^2 pi / (1/32 m^2) = 580 pieces.
TEST(PointRegion, TheOutlineFollowsTheSphere) {
  Plain plain;
  const AimSphere sphere{{300, 0, -200}, 2, 1};
  const std::vector<TrianglePiece> pieces = pieces_in(plain.scene.frame().surfaces[0], {&sphere, 1});
  EXPECT_NEAR(area_of(pieces), 4 * std::numbers::pi, 0.05 * 4 * std::numbers::pi);
  EXPECT_LT(pieces.size(), 580u);
  for (const TrianglePiece& piece : pieces) EXPECT_EQ(piece.spheres, 1u);
  EXPECT_TRUE(pieces_in(plain.scene.frame().surfaces[1], {&sphere, 1}).empty());
}

/// A triangle inside a sphere is not cut, and each piece lists all spheres that hold its middle.
TEST(PointRegion, WhatASphereHoldsStaysWhole) {
  Plain plain;
  const AimSphere spheres[] = {{{0, 3, 0}, 1, 1}, {{50, 3, 0}, 1, 1}, {{0, 2, 0}, 4, 1}};
  const std::vector<TrianglePiece> pieces = pieces_in(plain.scene.frame().surfaces[1], spheres);
  ASSERT_EQ(pieces.size(), 2u);
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_EQ(pieces[i].triangle, i);
    EXPECT_EQ(pieces[i].corners, TrianglePiece{}.corners);
    EXPECT_EQ(pieces[i].spheres, 0b101u);
  }
  EXPECT_NEAR(area_of(pieces), 0.04, 1e-6);
}

/// The spheres with the most weight per area come first, until they hold 95 of 100. A sphere without surface does not
/// count.
TEST(PointRegion, TheDensestSpheresAreTaken) {
  const AimSphere spheres[] = {{{}, 8, 4}, {{}, 1, 10}, {{}, 2, 86}, {{}, 3, 1000}};
  const double areas[] = {100, 1, 10, 0};
  const std::vector<AimSphere> taken = spheres_with_points(spheres, areas);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[0].weight, 10);  // 10 / m^2
  EXPECT_EQ(taken[1].weight, 86);  // 8.6 / m^2: 96 of 100 together
}

/// 4000 points per side in the spheres instead of on 4 km^2 have a spacing of sqrt(area / 4000), 6 cm instead of 32 m.
/// The wide sphere holds less than 5 % of the weight and most of the area: it gets no points.
TEST(PointRegion, PointsLieWhereCamerasLook) {
  Plain plain;
  PointOptions options;
  options.count = 4000;
  options.seen = {{{300, 0, -200}, 2, 1}, {{0, 3, 0}, 1, 0.1}, {{-500, 0, 0}, 100, 0.05}};
  const PlacedPoints placed = place_points(plain.scene.frame(), options);
  const double area = area_of(pieces_in(plain.scene.frame().surfaces[0], {options.seen.data(), 1})) + 0.04;
  EXPECT_NEAR(placed.spacing, std::sqrt(area / 4000), 1e-3 * placed.spacing);
  EXPECT_NEAR(double(placed.points.size()), 8000, 4);
  int small = 0;
  for (const IrradiancePoint& point : placed.points) {
    if (point.position.y > 1) {
      ++small;
      continue;
    }
    EXPECT_EQ(point.position.y, 0);
    EXPECT_LT(std::hypot(point.position.x - 300, point.position.z + 200), 2.4);
  }
  EXPECT_NEAR(small, 8000 * 0.04 / area, 3);
}

/// Points cover their pieces: their mean is the middle of the disc, within 3 standard errors of 4000 random places on a
/// disc of 2 m (1 m / sqrt(4000) in each coordinate; Sobol points are closer), and no two coincide.
TEST(PointRegion, PointsFillTheirPieces) {
  Plain plain;
  PointOptions options;
  options.count = 4000;
  options.seen = {{{300, 0, -200}, 2, 1}};
  Vec3d sum;
  std::set<std::pair<float, float>> places;
  int count = 0;
  for (const IrradiancePoint& point : place_points(plain.scene.frame(), options).points) {
    if (point.normal.y < 0) continue;
    sum = sum + Vec3d(point.position);
    places.insert({point.position.x, point.position.z});
    ++count;
  }
  EXPECT_NEAR(sum.x / count, 300, 3 / std::sqrt(4000.0));
  EXPECT_NEAR(sum.z / count, -200, 3 / std::sqrt(4000.0));
  EXPECT_GT(int(places.size()), count - 10);  // floats at 300 m have steps of 3e-5 m: a pair of 4000 may coincide
}

}  // namespace
}  // namespace tempolux
