// How irradiance bends: second derivatives from one hemisphere of radiance, against closed forms.
#include "lib/gather/hemisphere.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tempolux {
namespace {

/// What a point of the plane y = 0 sees of an emitter L = 1 at height h over x > x0, cells sampled at their middles.
Hemisphere half_plane(double h, double x0, int rings, int sectors) {
  Hemisphere sky;
  sky.reset(rings, sectors);
  for (int j = 0; j < rings; ++j)
    for (int k = 0; k < sectors; ++k) {
      const double sin2 = (j + 0.5) / rings, phi = 2 * M_PI * (k + 0.5) / sectors;
      const double reach = h * std::sqrt(sin2 / (1 - sin2));  // along the plane
      if (reach * std::cos(phi) <= x0) continue;
      const std::size_t cell = std::size_t(j * sectors + k);
      sky.radiance[cell] = Rgb(1.0f);
      sky.inverse_distance[cell] = float(std::sqrt(1 - sin2) / h);
    }
  return sky;
}

struct Place {
  double h, x0;
};
class HemisphereTest : public testing::TestWithParam<Place> {};

/// E = pi/2 (1 - x0 / sqrt(h^2 + x0^2)), so d2E/dx2 = 3 pi/2 h^2 x0 / (h^2 + x0^2)^(5/2) and nothing across: the mean size
/// of the two is half of it, for each of three channels. The edge is a staircase of cells and borders between sectors
/// are differentiated to first order: 10 % at 64 rings. An estimate of half the size or twice it fails.
TEST_P(HemisphereTest, CurvatureOfAHalfPlane) {
  const auto [h, x0] = GetParam();
  const double second = 1.5 * M_PI * h * h * x0 / std::pow(h * h + x0 * x0, 2.5);
  EXPECT_NEAR(double(half_plane(h, x0, 64, 201).curvature()) / (1.5 * std::abs(second)), 1, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Places, HemisphereTest, testing::Values(Place{0.5, 0.2}, Place{1, 0.6}, Place{1, -0.6}, Place{1, 1.5}));

TEST(Hemisphere, UniformLightDoesNotBend) {
  Hemisphere sky;
  sky.reset(13, 40);
  for (Rgb& l : sky.radiance) l = Rgb(0.7f);
  for (float& inverse : sky.inverse_distance) inverse = 3;
  EXPECT_EQ(sky.curvature(), 0);
  IrradianceRecord record;
  sky.irradiance_and_gradients(Frame({0, 0, 1}), record);
  EXPECT_NEAR(record.irradiance.g, 0.7 * M_PI, 1e-5);
  EXPECT_NEAR(sky.harmonic_distance(), 1.0 / 3, 1e-6);
}

/// One thing 2 m away in an empty landscape: what is near decides, not how much sky there is around it.
TEST(Hemisphere, TheSkyDoesNotMakeThingsFarther) {
  Hemisphere sky;
  sky.reset(10, 30);
  sky.inverse_distance[7] = sky.inverse_distance[120] = 0.5f;
  EXPECT_FLOAT_EQ(sky.harmonic_distance(), 2);
}

TEST(Hemisphere, CountsTheCellsThatCarryTheLight) {
  Hemisphere sky;
  sky.reset(10, 30);
  EXPECT_EQ(sky.lit_cells(), 0);
  for (std::size_t c = 0; c < 12; ++c) sky.radiance[c] = Rgb(3.0f);
  EXPECT_FLOAT_EQ(sky.lit_cells(), 12);
  sky.radiance[50] = Rgb(3000.0f);   // one outshines them
  EXPECT_NEAR(sky.lit_cells(), 1.0f, 0.03f);
}

TEST(Hemisphere, NothingThereIsFarAway) {
  Hemisphere sky;
  sky.reset(2, 7);
  EXPECT_EQ(sky.harmonic_distance(), INFINITY);
  EXPECT_EQ(sky.nearest_across(), INFINITY);
  EXPECT_EQ(sky.curvature(), 0);
}

}  // namespace
}  // namespace tempolux
