// Closed convex emitters: which are, and that only what shows is sampled.
#include "lib/light/convex_shell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/core/sobol.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

/// The octahedron |x| + |y| + |z| = 1, each face with corners of its own.
std::vector<Vec3> octahedron() {
  std::vector<Vec3> corners;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 x{octant & 1 ? -1.0f : 1.0f, 0, 0}, y{0, octant & 2 ? -1.0f : 1.0f, 0}, z{0, 0, octant & 4 ? -1.0f : 1.0f};
    const bool odd = ((octant ^ octant >> 1 ^ octant >> 2) & 1) != 0;
    corners.insert(corners.end(), {x, odd ? z : y, odd ? y : z});
  }
  return corners;
}

/// One surface of separate triangles.
std::uint32_t add_triangles(LightScene& scene, const std::vector<Vec3>& corners, bool flipped = false) {
  const std::uint32_t surface = scene.add(corners, Rgb(1.0f), true, flipped);
  auto& triangles = scene.primitives.back().triangles;
  triangles.clear();
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) triangles.push_back({i, i + 1, i + 2});
  return surface;
}

std::optional<Ball> shell_of(const std::vector<Vec3>& corners, bool flipped = false) {
  LightScene scene;
  return convex_shell(scene.frame.surfaces[add_triangles(scene, corners, flipped)]);
}

TEST(ConvexShell, IsFoundOfWhatIsClosedConvexAndOutwards) {
  const auto ball = shell_of(octahedron());
  ASSERT_TRUE(ball);
  EXPECT_NEAR(ball->radius, 1, 1e-4);
  EXPECT_NEAR(length(ball->centre), 0, 1e-6);
  EXPECT_FALSE(shell_of(octahedron(), true)) << "inwards";
  auto open = octahedron();
  open.resize(open.size() - 3);
  EXPECT_FALSE(shell_of(open)) << "a face is missing";
  auto dented = octahedron();
  for (Vec3& p : dented)
    if (p.z == 1) p.z = -0.5f;
  EXPECT_FALSE(shell_of(dented)) << "not convex";
}

// From outside, the octahedron of radiance 1 gives what its outline does, and every sample lies on a face that shows. From its
// middle all of it is seen: half of the sphere above the horizon, E = pi. The mean of 2^14 Sobol points is right to 1 %.
TEST(ConvexShell, OnlyWhatShowsIsSampled) {
  LightScene scene;
  add_triangles(scene, octahedron());
  const Lights lights = scene.lights();
  constexpr int kCount = 1 << 14;
  const auto irradiance = [&](Vec3 point, bool outside) {
    double sum = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      LightSample s;
      if (!lights.sample(point, {0, 0, 1}, sobol_owen_2d(i, 5), s)) continue;
      const Vec3 at = s.position, face{std::copysign(1.0f, at.x), std::copysign(1.0f, at.y), std::copysign(1.0f, at.z)};
      if (outside) {
        EXPECT_LT(dot(at - point, face), 1e-5f);
      }
      sum += double(s.radiance.g * std::max(0.0f, s.wi.z)) / kCount;
    }
    return sum;
  };
  // Seen along z its outline is a square of corners (+-1, 0), (0, +-1), of the lower faces each shows a quarter.
  const Vec3 below{0, 0, -3};
  const double exact = polygon_irradiance(below, {0, 0, 1}, {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}});
  EXPECT_NEAR(irradiance(below, true), exact, 0.01 * exact);
  EXPECT_NEAR(irradiance({0, 0, 0}, false), std::numbers::pi, 0.01 * std::numbers::pi);
}

}  // namespace
}  // namespace tempolux
