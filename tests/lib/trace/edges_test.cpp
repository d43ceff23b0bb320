// Rays at edges, corners and grazing angles: each is decided by our own arithmetic, none is lost and none meets a
// surface twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/trace/trace.h"
#include "lib/trace/triangle_hit.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

/// A number in [-.5, .5) for use `k` of ray i.
float random(std::uint32_t i, std::uint32_t k) { return PathRandom(23, i).get1(k, Purpose::test) - 0.5f; }
Vec3 random_vector(std::uint32_t i, std::uint32_t k) {
  return {random(i, 3 * k), random(i, 3 * k + 1), random(i, 3 * k + 2)};
}

TEST(MeetPlane, KnownValues) {
  const Vec3 a{0, 0, 2}, b{4, 0, 2}, c{0, 2, 2};
  const TriangleHit hit = meet_plane({1, 1, 0}, {0, 0, 0.5f}, a, b, c);
  EXPECT_EQ(hit.t, 4);
  EXPECT_EQ(hit.u, 0.25f);
  EXPECT_EQ(hit.v, 0.5f);
  EXPECT_EQ(meet_plane({1, 1, 4}, {0, 0, 0.5f}, a, b, c).t, -4);
  EXPECT_FALSE(std::isfinite(meet_plane({1, 1, 0}, {1, 0, 0}, a, b, c).t));  // parallel to the plane
}

/// A ray that passes the edge at x = 0 by .1 in the plane x + z = 2, which it meets at (-.1, .5, 2.1): its hit is the
/// place (0, .5, 2) of the edge, and the nearest point of the ray is at z = 2.
TEST(MeetTriangle, ARayBesideTheEdgeMeetsTheEdge) {
  const Vec3 a{0, 0, 2}, b{2, 0, 0}, c{0, 2, 2}, origin{-0.1f, 0.5f, 0}, up{0, 0, 1};
  EXPECT_NEAR(meet_plane(origin, up, a, b, c).t, 2.1f, 1e-6f);
  EXPECT_TRUE(meet_plane(origin, up, a, b, c).outside());
  const TriangleHit hit = meet_triangle(origin, up, a, b, c);
  EXPECT_EQ(hit.t, 2);
  EXPECT_EQ(hit.u, 0);
  EXPECT_NEAR(hit.v, 0.25f, 1e-6f);
}

/// Pairs of triangles that share an edge, with one on each side of it as the ray sees it; the ray is aimed at a point
/// on the edge. The ray must meet one of them, and behind the met surface it must meet nothing. Each pair has a place
/// of its own, 8 m from the next, and a ray ends before it reaches another pair.
TEST(Tracer, RaysThroughSharedEdgesAreNeitherLostNorCountedTwice) {
  constexpr std::uint32_t kScenes = 20, kPairs = 50'000, kSide = 37;  // 37^3 > kPairs
  int lost = 0, twice = 0, unequal = 0;
  for (std::uint32_t s = 0; s < kScenes; ++s) {
    std::vector<Vec3> corners;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Ray> rays;
    for (std::uint32_t n = 0; n < kPairs; ++n) {
      const std::uint32_t i = s * kPairs + n, first = std::uint32_t(corners.size());
      const Vec3 place = Vec3{float(n % kSide), float(n / kSide % kSide), float(n / kSide / kSide)} * 8;
      const Vec3 p = place + random_vector(i, 0), q = place + random_vector(i, 1);
      const Vec3 origin = place + random_vector(i, 2) * 4, on = p + (q - p) * (0.5f + 0.8f * random(i, 20));
      const Vec3 across = normalize(cross(q - p, on - origin)), deep = normalize(on - origin);
      const auto apex = [&](std::uint32_t k, float side) {
        return on + across * (side * (0.1f + 0.4f * std::abs(random(i, k)))) + deep * random(i, k + 1) +
               (q - p) * random(i, k + 2);
      };
      corners.insert(corners.end(), {p, q, apex(30, 1), apex(40, -1)});
      triangles.push_back({first, first + 1, first + 2});
      triangles.push_back({first + 1, first, first + 3});
      rays.push_back({origin, on - origin, 0, 2});
    }
    HandMadeScene scene;
    scene.add(corners, triangles, matte(Rgb(0.5f)));
    const Tracer tracer(scene.frame());
    for (Ray ray : rays) {
      Hit hit;
      if (!tracer.intersect(ray, hit)) {
        ++lost;
        continue;
      }
      unequal += !tracer.occluded(ray);
      pass_surface(tracer.surface_point(hit), hit.t, ray);
      twice += tracer.intersect(ray, hit);
    }
  }
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(twice, 0);
  EXPECT_EQ(unequal, 0);
}

/// Bounds of the distance of the nearest hit, by a loop over all triangles.
struct Bounds {
  double low = INFINITY, high = INFINITY;
};
/// low is that of triangles whose borders lie farther out by `more` of the barycentric coordinates, over the cosine
/// between ray and normal; high is that of triangles that are smaller by as much. A ray that passes the triangle itself
/// meets the nearest place of its border, which may come as much earlier on the ray as it lies in the plane.
Bounds nearest(const std::vector<Vec3>& p, const Ray& ray, double more) {
  Bounds t;
  for (std::size_t i = 0; i + 2 < p.size(); i += 3) {
    const Vec3d a(p[i]), e1 = Vec3d(p[i + 1]) - a, e2 = Vec3d(p[i + 2]) - a, d(ray.direction),
                         s = Vec3d(ray.origin) - a;
    const double det = dot(e1, cross(d, e2));
    if (det == 0) continue;
    const double u = dot(s, cross(d, e2)) / det, v = dot(d, cross(s, e1)) / det, inside = std::min({u, v, 1 - u - v}),
                 distance = dot(e2, cross(s, e1)) / det,
                 border = more * length(cross(e1, e2)) * length(d) / std::abs(det),
                 earlier = inside < 0 ? border * (length(e1) + length(e2)) / length(d) : 0;
    if (inside >= -border && distance > -earlier) t.low = std::min(t.low, distance - earlier);
    if (inside >= border && distance > 0) t.high = std::min(t.high, distance);
  }
  return t;
}

/// A bumpy sphere, and rays at its corners, at its edges, and along the planes of its triangles. The distance lies
/// between those of triangles that are a little larger and a little smaller. "A little" is .00001 of a barycentric
/// coordinate: single precision decides whether a ray passes an edge, with an error of 2^-22 of the distance (2 m)
/// across the ray, over the height of the triangle (at least .08 m). Many rays at once give the same hits.
TEST(Tracer, HitsAgreeWithALoopInDoublePrecision) {
  HandMadeScene scene;
  scene.add_sphere({}, 1, 4, matte(Rgb(0.5f)), false, false);
  std::vector<Vec3> corners = scene.last_positions();
  for (Vec3& p : corners) p = p * (1 + 0.1f * std::sin(7 * p.x) * std::cos(5 * p.y + 3 * p.z));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec3> loop;
  HandMadeScene bumpy;
  {
    const SceneFrame& frame = scene.frame();
    for (const auto& t : frame.surfaces[0].primitive->triangles) {
      triangles.push_back(t);
      for (const std::uint32_t c : t) loop.push_back(corners[c]);
    }
    bumpy.add(corners, triangles, matte(Rgb(0.5f)));
  }
  const Tracer tracer(bumpy.frame());
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < 1'000'000; ++i) {
    const std::size_t t = 3 * (i % (loop.size() / 3));
    const Vec3 a = loop[t], b = loop[t + 1], c = loop[t + 2];
    const Vec3 at = i % 3 == 0 ? a : i % 3 == 1 ? a + (b - a) * (0.5f + random(i, 0)) : (a + b + c) * (1.f / 3);
    const Vec3 normal = normalize(cross(b - a, c - a));
    Vec3 from = normalize(random_vector(i, 1)) * 2;
    if (i % 3 == 2)
      from = at + (a - b) * (1 + 4 * std::abs(random(i, 8))) + normal * (1e-4f * random(i, 9));  // grazing
    rays.push_back({from, at - from});
  }
  std::vector<Hit> hits(rays.size());
  tracer.intersect(rays, hits);
  int found = 0, wrong = 0, differing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto [low, high] = nearest(loop, rays[i], 1e-5);
    Hit alone;
    const bool met = tracer.intersect(rays[i], alone);
    const double t = met ? double(alone.t) : double(INFINITY);
    wrong += !(t >= low * (1 - 1e-6) && (t <= high * (1 + 1e-6)));
    differing += met != (hits[i].surface != kNone) ||
                 (met && (alone.triangle != hits[i].triangle || alone.t != hits[i].t || alone.u != hits[i].u));
    found += met;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(differing, 0);
  EXPECT_GT(found, 700'000);
}

/// Of surfaces at equal distance the one that stands, then the first of the scene is met, by every ray.
TEST(Tracer, CoincidentSurfacesAreOneSurface) {
  HandMadeScene scene;
  scene.add_quad({-3, 1, 2}, {3, 1, 2}, {3, 1, -3}, {-3, 1, -3}, matte(Rgb(0.9f)), true);
  scene.add_quad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, matte(Rgb(0.1f)));
  scene.add_quad({-2, 1, 2.5f}, {2.5f, 1, 2}, {2, 1, -2}, {-2.5f, 1, -2}, matte(Rgb(0.3f)));
  const Tracer tracer(scene.frame());
  int wrong = 0;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const Vec3 target{1.9f * random(i, 0), 1, 1.9f * random(i, 1)}, from = random_vector(i, 2);
    Hit hit;
    wrong += !tracer.intersect({from, target - from}, hit) || hit.surface != 0;
  }
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace tempolux
