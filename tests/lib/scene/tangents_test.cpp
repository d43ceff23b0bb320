// Tangents made for meshes that come without: against formulas of sphere and cylinder, at seams, for morph targets.
#include "lib/scene/tangents.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lib/scene/scene.h"

namespace tempolux {
namespace {

constexpr float kPi = 3.14159265f;

/// A surface of columns x rows cells over (u, v) in [0, 1]^2; the corners of a cell run counter-clockwise where v
/// points down. Cells do not share vertices, so equal vertices must be found.
Primitive patch(int columns, int rows, const std::function<Vec3(float, float)>& position,
                const std::function<Vec3(float, float)>& normal, const std::function<Vec2(float, float)>& uv) {
  Primitive p;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto first = std::uint32_t(p.positions.size());
      const int at[4][2] = {{i, j}, {i, j + 1}, {i + 1, j + 1}, {i + 1, j}};
      for (const auto& [x, y] : at) {
        const float u = float(x) / float(columns), v = float(y) / float(rows);
        p.positions.push_back(position(u, v));
        p.normals.push_back(normal(u, v));
        p.uvs.push_back(uv(u, v));
      }
      p.triangles.push_back({first, first + 1, first + 2});
      p.triangles.push_back({first, first + 2, first + 3});
    }
  return p;
}
Vec2 same(float u, float v) { return {u, v}; }

Texture map() {
  Texture texture;
  texture.image = 0;
  return texture;
}

/// Largest distance of a tangent from `expected`.
float worst(const Primitive& p, const std::function<Vec3(Vec3)>& expected, const std::function<bool(Vec2)>& where) {
  EXPECT_EQ(p.tangents.size(), p.positions.size());
  float most = 0;
  for (std::size_t v = 0; v < p.tangents.size(); ++v)
    if (where(p.uvs[v])) most = std::max(most, length(p.tangents[v] - expected(p.normals[v])));
  return most;
}

// A cylinder of 24 flat strips, u around, y up. Within a strip the direction of u differs by 7.5 degrees from the
// circle's tangent; projected onto the tangent plane it equals this tangent. At the seam u jumps from 1 to 0, so the
// seam has two vertices at each place, one for each strip, with equal tangents.
TEST(Tangents, FollowACylinder) {
  const auto around = [](float u, float v) { return Vec3{std::cos(2 * kPi * u), 1 - v, -std::sin(2 * kPi * u)}; };
  const auto outwards = [](float u, float) { return Vec3{std::cos(2 * kPi * u), 0, -std::sin(2 * kPi * u)}; };
  Primitive p = patch(24, 3, around, outwards, same);
  make_tangents(p, map());
  EXPECT_EQ(p.positions.size(), 4u * 24 * 3);  // no vertex has two tangents
  EXPECT_LT(worst(
                p,
                [](Vec3 n) {
                  return Vec3{n.z, 0, -n.x};
                },
                [](Vec2) { return true; }),
            1e-5f);
  for (const float side : p.tangent_sides) EXPECT_EQ(side, 1);  // image upright as seen from outside: up is n x right
}

// A sphere of 64 x 32 cells, u around, v from pole to pole. Every triangle has an edge along a parallel, and its
// direction of u is this chord, half a cell (pi / 64) before or behind the vertex. Projected onto the vertex' tangent
// plane, the chord leans by pi / 64 x cos(v pi) from the parallel. The chords before and behind the vertex have equal
// angles at their corners, so their leanings cancel, except at the seam, where u is 0 or 1 and only one side
// contributes.
TEST(Tangents, FollowASphere) {
  const auto at = [](float u, float v) {
    const float phi = 2 * kPi * u, theta = kPi * v;
    return Vec3{std::cos(phi) * std::sin(theta), std::cos(theta), -std::sin(phi) * std::sin(theta)};
  };
  Primitive p = patch(64, 32, at, at, same);
  std::erase_if(p.triangles, [&](const auto& t) {  // at the poles
    const auto apart = [&](int a, int b) { return length(p.positions[t[a]] - p.positions[t[b]]) > 1e-4f; };
    return !(apart(0, 1) && apart(1, 2) && apart(2, 0));
  });
  make_tangents(p, map());
  const auto parallel = [](Vec3 n) { return normalize(Vec3{n.z, 0, -n.x}); };
  const auto seam = [](Vec2 uv) { return uv.x == 0 || uv.x == 1; };
  EXPECT_LT(worst(p, parallel, [&](Vec2 uv) { return uv.y > 0.05f && uv.y < 0.95f && !seam(uv); }), 1e-3f);
  const auto at_seam = [&](Vec2 uv) { return uv.y == 0.125f && seam(uv); };
  EXPECT_NEAR(worst(p, parallel, at_seam), kPi / 64 * std::cos(kPi / 8), 1e-3);
}

// The right half shows the image, the left half shows it mirrored: u = |x|. Vertices of the seam have equal
// positions, normals and coordinates but two tangents, so each becomes two vertices.
TEST(Tangents, VerticesOfAMirroredSeamAreParted) {
  Primitive p;
  p.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  p.normals.assign(6, {0, 0, 1});
  p.uvs = {{1, 1}, {0, 1}, {1, 1}, {1, 0}, {0, 0}, {1, 0}};
  p.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  p.influences_per_vertex = 1;
  for (std::uint16_t v = 0; v < 6; ++v) p.influences.push_back({v, 1});
  make_tangents(p, map());
  ASSERT_EQ(p.positions.size(), 8u);
  ASSERT_EQ(p.influences.size(), 8u);
  for (std::size_t t = 0; t < 4; ++t)
    for (const std::uint32_t v : p.triangles[t]) {
      EXPECT_EQ(p.tangents[v], (t < 2 ? Vec3{-1, 0, 0} : Vec3{1, 0, 0}));
      EXPECT_EQ(p.tangent_sides[v], t < 2 ? -1 : 1);  // up is +y on both
    }
  for (std::size_t v = 6; v < 8; ++v) EXPECT_EQ(p.positions[v], p.positions[p.influences[v].joint]);
}

// Three corners of 30, 60 and 90 degrees meet in a plane; their edges have different lengths. Within each triangle u
// and v are linear. The tangent is the direction in which v is constant and u grows, weighted by the corner's angle.
TEST(Tangents, AreWeightedByAngles) {
  const auto corner = [](float degrees, float radius) {
    return Vec3{radius * std::cos(degrees * kPi / 180), radius * std::sin(degrees * kPi / 180), 0};
  };
  const Vec3 a = corner(0, 1), b1 = corner(30, 5), b2 = corner(90, 2), d = corner(180, 1);
  Primitive p;
  p.positions = {{0, 0, 0}, a, b1, b2, d};
  p.normals.assign(5, {0, 0, 1});
  p.uvs = {{0, 0}, {1, 0}, {0.5f, -1}, {-0.5f, -1}, {-1, 0.25f}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  make_tangents(p, map());
  Vec3d expected{};
  const double angle[] = {kPi / 6, kPi / 3, kPi / 2};
  for (std::size_t t = 0; t < 3; ++t) {
    const auto& c = p.triangles[t];
    const Vec3 e1 = p.positions[c[1]], e2 = p.positions[c[2]];
    const double det = double(e1.x) * e2.y - double(e2.x) * e1.y;
    const auto gradient = [&](double f1, double f2) {
      return Vec3d{(f1 * e2.y - f2 * e1.y) / det, (f2 * e1.x - f1 * e2.x) / det, 0};
    };
    const Vec3d u = gradient(p.uvs[c[1]].x, p.uvs[c[2]].x), v = gradient(p.uvs[c[1]].y, p.uvs[c[2]].y);
    Vec3d along{-v.y, v.x, 0};
    if (dot(along, u) < 0) along = -along;
    expected += normalize(along) * angle[t];
  }
  EXPECT_LT(length(Vec3d(p.tangents[0]) - normalize(expected)), 1e-5);
}

TEST(Tangents, WhereCoordinatesSayNothing) {
  // The coordinates of the second triangle have no area. It takes the first triangle's tangent at the edge that they
  // share, and none at its third corner. The third triangle touches them at one vertex and takes the tangent there,
  // too.
  Primitive p;
  p.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, 0}, {2, 2, 0}};
  p.normals.assign(6, {0, 0, 1});
  p.uvs = {{0, 1}, {1, 1}, {1, 0}, {0.5f, 0.5f}, {1, 0}, {1, 0}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 4, 5}};
  make_tangents(p, map());
  EXPECT_EQ(p.positions.size(), 6u);
  EXPECT_EQ(p.tangents[2], (Vec3{1, 0, 0}));
  EXPECT_EQ(p.tangents[3], (Vec3{0, 0, 0}));
  Primitive none = p;
  none.tangents.clear(), none.tangent_sides.clear(), none.uvs.clear();
  make_tangents(none, map());
  EXPECT_TRUE(none.tangents.empty());
}

// A texture transform that turns the image turns the tangents. Morph targets change the tangents with the surface: a
// target turns a square of the plane x, y upright, so x becomes z.
TEST(Tangents, FollowTransformsAndMorphTargets) {
  Primitive square;
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.normals.assign(4, {0, 0, 1});
  square.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  Primitive turned = square;
  Texture quarter = map();
  quarter.transform = {0, 1, 0, -1, 0, 0};  // u' = v, v' = -u: u' grows downwards on the square
  make_tangents(turned, quarter);
  EXPECT_EQ(turned.tangents[0], (Vec3{0, -1, 0}));
  square.targets.resize(2);
  for (const Vec3& p : square.positions) square.targets[0].positions.push_back({-p.x, 0, p.x});
  square.targets[0].normals.assign(4, {-1, 0, -1});
  make_tangents(square, map());
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(square.tangents[v], (Vec3{1, 0, 0}));
    EXPECT_LT(length(square.tangents[v] + square.targets[0].tangents[v] - Vec3{0, 0, 1}), 1e-6f);
  }
  EXPECT_TRUE(square.targets[1].tangents.empty());
}

}  // namespace
}  // namespace tempolux
