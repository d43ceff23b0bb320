// Large lights: irradiance without shadows against Lambert's sum, points on rectangles against it, and all lights together.
#include "lib/light/large_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/core/sobol.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

std::vector<LargeLight> large_lights(const std::vector<Vec3>& corners, bool two_sided = false) {
  LightScene scene;
  scene.add(corners, Rgb(1.0f), two_sided);
  std::vector<TriangleLight> triangles;
  for (std::uint32_t t = 0; t + 2 < corners.size(); ++t) triangles.emplace_back(scene.frame, 0, t, EmissionShares());
  return join_rectangles(triangles);
}

TEST(LargeLight, TwoHalvesOfARectangleAreOneOtherQuadsStayTwo) {
  const auto square = large_lights(square_facing_down({1, 2, 3}, 0.5f));
  ASSERT_EQ(square.size(), 1u);
  EXPECT_TRUE(square[0].is_rectangle());
  const auto rhombus = large_lights({{0, -1, 1}, {-2, 0, 1}, {0, 1, 1}, {2, 0, 1}});
  EXPECT_EQ(rhombus.size(), 2u);
  const auto bent = large_lights({{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1.1f}});
  EXPECT_EQ(bent.size(), 2u);
}

// From near to where its sum loses digits; the tolerance is the stated 1e-5, of positions of 2^-24 too.
TEST(LargeLight, IrradianceIsLambertsSum) {
  for (const auto& [height, half] : {std::pair{0.01f, 0.5f}, {0.2f, 0.5f}, {1.0f, 0.5f}, {5.0f, 0.5f}, {100.0f, 0.5f}, {2.0f, 30.0f}}) {
    const auto corners = square_facing_down({0.1f, 0.2f, height}, half);
    const LargeLight light = large_lights(corners)[0];
    const double exact = polygon_irradiance({0, 0, 0}, {0, 0, 1}, corners);
    EXPECT_NEAR(projected_solid_angle(light, {0, 0, 0}, {0, 0, 1}), exact, 1e-5 * exact) << height;
    EXPECT_EQ(projected_solid_angle(light, {0, 0, 0}, {0, 0, -1}), 0);
    EXPECT_EQ(projected_solid_angle(light, {0, 0, 2 * height}, {0, 0, -1}), 0) << "from behind";
  }
}

// What is below the horizon does not count: a wall's point beside the middle of a square sees half of it, and as much as of
// that half alone. Above it counts whole.
TEST(LargeLight, TheHorizonCutsIt) {
  const LargeLight light = large_lights(square_facing_down({0, 0, 1}, 1))[0];
  const std::vector<Vec3> half{{0, -1, 1}, {0, 1, 1}, {1, 1, 1}, {1, -1, 1}};
  EXPECT_NEAR(projected_solid_angle(light, {0, 0, 0}, {1, 0, 0}), polygon_irradiance({0, 0, 0}, {1, 0, 0}, half), 1e-5);
  // Tilted so that one corner is below: the other two triangles' corners are above.
  const Vec3 tilted = normalize(Vec3{1, 1, 1.5f});
  const std::vector<Vec3> rest{{-0.5f, -1, 1}, {-1, -0.5f, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}};
  EXPECT_NEAR(projected_solid_angle(light, {0, 0, 0}, tilted), polygon_irradiance({0, 0, 0}, tilted, rest), 1e-5);
}

// Means over 2^14 Sobol points: of cos / pdf the irradiance, of 1 / pdf the solid angle (a cube's face: 2 pi / 3), of the
// direction that of the light. Points of such a net differ from the mean by less than 1e-3 for these smooth functions.
TEST(LargeLight, PointsOnARectangleAreUniformInSolidAngle) {
  constexpr int kCount = 1 << 14;
  for (const Vec3 from : {Vec3{0, 0, 0}, Vec3{0.9f, -0.7f, 0.5f}, Vec3{3, 1, -2}, Vec3{0.2f, 0.1f, -14}}) {
    const LargeLight light = large_lights(square_facing_down({0, 0, 1}, 1))[0];
    double irradiance = 0, angle = 0, first = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      LargeLightPoint p;
      ASSERT_TRUE(sample_large_light(light, from, sobol_owen_2d(i, 7), p));
      EXPECT_NEAR(p.position.z, 1, 1e-5);
      EXPECT_LE(std::max(std::abs(p.position.x), std::abs(p.position.y)), 1 + 1e-5f);
      irradiance += double(p.wi.z) / p.pdf_solid_angle / kCount;
      angle += 1 / p.pdf_solid_angle / kCount;
      // More than the area: what lies in the half x < 0 is what that half gives.
      if (p.position.x < 0) first += double(p.wi.z) / p.pdf_solid_angle / kCount;
    }
    const auto corners = square_facing_down({0, 0, 1}, 1);
    const double exact = polygon_irradiance(from, {0, 0, 1}, corners);
    EXPECT_NEAR(irradiance, exact, 1e-3 * exact);
    EXPECT_NEAR(first, polygon_irradiance(from, {0, 0, 1}, {{-1, -1, 1}, {-1, 1, 1}, {0, 1, 1}, {0, -1, 1}}), 2e-3 * exact);
    if (from == Vec3{}) { EXPECT_NEAR(angle, 2 * std::numbers::pi / 3, 1e-4); }
  }
}

// What is asked for together has nothing to do with each other: far and near points, one behind the light, one beside it in
// its plane, small numbers of them, a triangle as well.
TEST(LargeLight, ManyPointsAtOnceAreThoseOneByOne) {
  const std::vector<Vec3> from{{0, 0, 0}, {0.9f, -0.7f, 0.5f}, {0, 0, 2}, {3, 1, -2}, {0.2f, 0.1f, -14}, {5, 0, 1}, {0, 0, 0.999f}, {-2, 2, 0.9f}};
  const auto corners = square_facing_down({0, 0, 1}, 1);
  const LargeLight rectangle = large_lights(corners)[0], triangle = large_lights({corners[0], corners[1], corners[2]})[0];
  for (const LargeLight& light : {rectangle, triangle})
    for (std::size_t count = 1; count <= from.size(); ++count) {
      std::vector<Vec2> u;
      for (std::size_t i = 0; i < count; ++i) u.push_back(sobol_owen_2d(std::uint32_t(i), count));
      std::vector<LargeLightPoint> together(count);
      const unsigned found = sample_large_light(light, std::span(from).first(count), u, together.data());
      for (std::size_t i = 0; i < count; ++i) {
        LargeLightPoint alone;
        ASSERT_EQ(found >> i & 1, unsigned(sample_large_light(light, from[i], u[i], alone))) << i;
        ASSERT_EQ(together[i].position, alone.position) << i;
        ASSERT_EQ(together[i].wi, alone.wi) << i;
        ASSERT_EQ(together[i].pdf_solid_angle, alone.pdf_solid_angle) << i;
      }
      EXPECT_EQ(found, 0xdbu & ((1u << count) - 1));   // all but those behind it and in its plane
    }
}

TEST(LargeLight, BothSidesOfATwoSidedOneShine) {
  const auto corners = square_facing_down({0, 0, 1}, 1);
  const LargeLight light = large_lights(corners, true)[0];
  const Vec3 above{0.2f, 0.3f, 2.5f};
  EXPECT_NEAR(projected_solid_angle(light, above, {0, 0, -1}), polygon_irradiance(above, {0, 0, -1}, corners), 1e-5);
  LargeLightPoint p;
  ASSERT_TRUE(sample_large_light(light, above, {0.3f, 0.6f}, p));
  EXPECT_LT(p.wi.z, 0);
}

// A panel and a far lamp of many triangles, of which a part is below the horizon: large and rest together are all light, and
// the large one's is known. 2^16 points; what is left of the noise of random ones is below 4 sigma.
TEST(LargeLight, AndTheRestAreAllLights) {
  LightScene scene;
  const auto panel = square_facing_down({0, 0, 3}, 1);
  scene.add(panel, Rgb(1, 2, 3));
  std::vector<std::vector<Vec3>> small;
  for (int i = 0; i < 40; ++i) {
    const float x = 2 + 0.2f * float(i % 8), y = 0.2f * float(i / 8);
    small.push_back({{x, y, 1}, {x, y + 0.1f, 1}, {x + 0.1f, y, 1}});
    scene.add(small.back(), Rgb(4, 2, 1));
  }
  scene.add(PunctualLight::Kind::point, Rgb(0.5f), {-1, 0, 1}, {});
  const Lights lights = scene.lights();
  ASSERT_TRUE(lights.has_large());
  const Vec3 normal = normalize(Vec3{0.3f, 0, 1});
  const Lights::Apart at = lights.apart({0, 0, 0}, normal);
  constexpr int kCount = 1 << 16;
  double large = 0, rest = 0, rest2 = 0, exact_rest = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    LightSample s;
    ASSERT_TRUE(lights.sample_large(at, sobol_owen_2d(i, 1), s));
    EXPECT_NEAR(at.irradiance.g, 2 * polygon_irradiance({0, 0, 0}, normal, panel), 1e-4);
    large += double(s.radiance.g * std::max(0.0f, dot(s.wi, normal))) / kCount;
    if (!lights.sample_rest(at, sobol_owen_2d(i, 2), s)) continue;
    const double e = double(s.radiance.g * std::max(0.0f, dot(s.wi, normal)));
    rest += e / kCount;
    rest2 += e * e / kCount;
  }
  for (const auto& triangle : small) exact_rest += 2 * polygon_irradiance({0, 0, 0}, normal, triangle);
  exact_rest += 0.5 / 2 * double(dot(normal, normalize(Vec3{-1, 0, 1})));
  EXPECT_NEAR(large, 2 * polygon_irradiance({0, 0, 0}, normal, panel), 1e-3 * large);
  EXPECT_NEAR(rest, exact_rest, 4 * std::sqrt((rest2 - rest * rest) / kCount));
}

TEST(LargeLight, ManyEqualLampsHaveNone) {
  LightScene scene;
  for (int i = 0; i < 21; ++i) scene.add({{float(i), 0, 1}, {float(i), 0.1f, 1}, {float(i) + 0.1f, 0, 1}}, Rgb(1.0f));
  EXPECT_FALSE(scene.lights().has_large());
}

}  // namespace
}  // namespace tempolux
