// Light of triangles is drawn by the cosine as well: maps of the square against their densities, triangles against
// closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"
#include "lib/core/sobol.h"
#include "lib/light/spherical_triangle.h"
#include "lib/light/triangle_light.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

/// The map takes a share of the square to where its density has it: of the quarter u.x, u.y < 1/2 the integral of the
/// bilinear density is known (its corner values 1, 2, 3, 6 have the means 1, 1.5, 2, 3 at the quarter's corners: 7.5 /
/// 4 / 3 of a fourth).
TEST(BilinearWarp, FollowsItsDensity) {
  const BilinearWarp warp({1, 2, 3, 6});
  int inside = 0;
  double inverse = 0;
  constexpr std::uint32_t kCount = 1 << 16;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Vec2 u = warp(sobol_owen_2d(i, 7));
    inside += u.x < 0.5f && u.y < 0.5f;
    inverse += 1 / warp.density(u) / kCount;
  }
  EXPECT_NEAR(double(inside) / kCount, 7.5 / 4 / 3 / 4,
              1e-3);  // Sobol points: some of their number's root on the border
  EXPECT_NEAR(inverse, 1, 1e-3);
}

/// Of a triangle, by the vectors to its corners [Van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30(2), 1983].
double solid_angle(Vec3d a, Vec3d b, Vec3d c) {
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(std::abs(dot(a, cross(b, c))), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

TEST(SphericalTriangle, FindsTheNumbersOfADirection) {
  for (const auto& [a, b, c] :
       {std::array<Vec3, 3>{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {Vec3{-3, 1, 2}, {2, 2, 1}, {0, -1, 4}}}) {
    const SphericalTriangle t = as_seen(a, b, c);
    const double omega = solid_angle(Vec3d(a), Vec3d(b), Vec3d(c));
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const Vec2 u = sobol_owen_2d(i, 1);
      const Vec2 back = find_in_spherical_triangle(t, omega, sample_spherical_triangle(t, omega, u));
      EXPECT_NEAR(back.y, u.y, 1e-6);
      if (u.y > 1e-3f) { EXPECT_NEAR(back.x, u.x, 1e-5); }
    }
  }
}

/// A triangle overhead, by a wall, small and far: the density that sample() says is that of pdf_solid_angle(), and
/// where nothing hides the lamp the samples differ little: their deviation was .15 to .6 of the mean by solid angle or
/// area alone.
TEST(LampsByCosine, SamplesHaveTheirDensityAndDifferLittle) {
  for (const auto& [normal, height, half] :
       {std::tuple{Vec3{0, 0, 1}, 1.0f, 0.5f}, {Vec3{0.8f, 0, 0.6f}, 1.0f, 0.5f}, {Vec3{0.6f, 0, 0.8f}, 5.0f, 0.2f}}) {
    LightScene scene;
    auto corners = square_facing_down({1.5f, 0.2f, height}, half);
    corners.pop_back();
    scene.add(corners, Rgb(1.0f));
    const Lights lights = scene.lights();
    double sum = 0, square = 0;
    constexpr std::uint32_t kCount = 1 << 12;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      LightSample s;
      ASSERT_TRUE(lights.sample({0, 0, 0}, normal, sobol_owen_2d(i, 5), s));
      EXPECT_NEAR(
          double(lights.pdf_solid_angle({0, 0, 0}, normal, 0, 0, s.position, {0, 0, -1})) / double(s.pdf_solid_angle),
          1, 2e-3);
      const double e = double(s.facing_irradiance.r) * double(dot(normal, s.wi));
      sum += e / kCount;
      square += e * e / kCount;
    }
    const double exact = polygon_irradiance({0, 0, 0}, normal, corners);
    EXPECT_NEAR(sum, exact, 1e-3 * exact);
    EXPECT_LT(std::sqrt(std::max(0.0, square - sum * sum)), 0.1 * exact);
  }
}

}  // namespace
}  // namespace tempolux
