// Rays against triangles: nearest hit, two trees, refused rays, no self hits, no leaks.
#include "lib/trace/trace.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "lib/core/random.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

Vec3 random_point(std::uint32_t i, std::uint32_t k, float size) {
  const PathRandom random(17, i);
  const Vec2 a = random.get2(k, Purpose::test);
  return Vec3{a.x - 0.5f, a.y - 0.5f, random.get1(k, Purpose::test, 1) - 0.5f} * size;
}

/// Moeller and Trumbore in double.
double brute_force(const SceneFrame& frame, const Ray& ray) {
  double nearest = INFINITY;
  for (const Surface& surface : frame.surfaces)
    for (const auto& t : surface.primitive->triangles) {
      const Vec3d a(surface.positions[t[0]]), e1 = Vec3d(surface.positions[t[1]]) - a,
                                              e2 = Vec3d(surface.positions[t[2]]) - a;
      const Vec3d d(ray.direction), o = Vec3d(ray.origin) - a, p = cross(d, e2);
      const double det = dot(e1, p), u = dot(o, p) / det, v = dot(d, cross(o, e1)) / det,
                   s = dot(e2, cross(o, e1)) / det;
      if (det != 0 && u >= 0 && v >= 0 && u + v <= 1 && s > 0) nearest = std::min(nearest, s);
    }
  return nearest;
}

TEST(Tracer, NearestHitOfBothTreesAgreesWithBruteForce) {
  HandMadeScene scene;
  for (std::uint32_t i = 0; i < 60; ++i)
    scene.add({random_point(i, 0, 4), random_point(i, 1, 4), random_point(i, 2, 4)}, {{0, 1, 2}}, matte(Rgb(0.5f)),
              i % 2 == 1);
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  int hits = 0, differing = 0;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const Ray ray{random_point(i, 5, 6), normalize(random_point(i, 6, 1)), 0, INFINITY};
    Hit hit;
    const bool found = tracer.intersect(ray, hit);
    const double expected = brute_force(frame, ray);
    if (found != (expected < INFINITY)) {
      ++differing;
      continue;
    }  // rays along edges: rounding decides
    EXPECT_EQ(tracer.occluded(ray), found);
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(double(hit.t), expected, 1e-5 * (1 + expected));
    const SurfacePoint point = tracer.surface_point(hit);
    EXPECT_LT(length(point.position - (ray.origin + ray.direction * hit.t)), 2e-5f);
  }
  EXPECT_GT(hits, 1000);
  EXPECT_LE(differing, 2);
}

TEST(Tracer, ManyRaysAtOnceMeetWhatEachMeetsAlone) {
  HandMadeScene scene;
  for (std::uint32_t i = 0; i < 60; ++i)
    scene.add({random_point(i, 0, 4), random_point(i, 1, 4), random_point(i, 2, 4)}, {{0, 1, 2}}, matte(Rgb(0.5f)),
              i % 2 == 1);
  const Tracer tracer(scene.frame());
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < 5003; ++i)  // no multiple of a packet
    rays.push_back({random_point(i / 50, 5, 6), normalize(random_point(i, 6, 1)), 0, i % 7 ? INFINITY : 1.5f});
  for (std::uint32_t i = 3; i < 5003; i += 100) rays[i].direction.y = NAN;
  std::vector<Hit> hits(rays.size());
  const std::uint64_t refused = tracer.refused_ray_count();
  tracer.intersect(rays, hits);
  EXPECT_EQ(tracer.refused_ray_count() - refused, 50u);
  int found = 0, differing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit alone;
    tracer.intersect(rays[i], alone);
    if (hits[i].surface != alone.surface) {  // an edge: rounding decides
      ++differing;
      continue;
    }
    if (alone.surface == kNone) continue;
    ++found;
    EXPECT_EQ(hits[i].triangle, alone.triangle);
    EXPECT_NEAR(hits[i].t, alone.t, 1e-5f * (1 + alone.t));
    EXPECT_NEAR(hits[i].u, alone.u, 1e-4f);
    EXPECT_NEAR(hits[i].v, alone.v, 1e-4f);
  }
  EXPECT_GT(found, 1000);
  EXPECT_LE(differing, 2);
}

/// A ceiling on which the bottom of a roof lies, as people export them. Gather rays in lists and pixels' rays alone
/// must agree which of the two they see.
TEST(Tracer, ManyRaysAtOnceMeetWhatEachMeetsAloneWhereSurfacesCoincide) {
  HandMadeScene scene;
  scene.add_quad({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, matte(Rgb(0.7f)));
  scene.add_quad({-0.1f, 1, 1.1f}, {1.1f, 1, 1.1f}, {1.1f, 1, -0.1f}, {-0.1f, 1, -0.1f}, matte(Rgb(0.1f)));
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Vec3 at = random_point(i, 0, 1) + Vec3{0.5f, 0.5f, 0.5f};
    scene.add({at, at + random_point(i, 1, 0.1f), at + random_point(i, 2, 0.1f)}, {{0, 1, 2}}, matte(Rgb(0.5f)));
  }
  const Tracer tracer(scene.frame());
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < 4096; ++i) {  // from 64 places, in similar directions
    const Vec3 from{float(i / 64 % 8 + 1) / 9, 0, float(i / 512 + 1) / 9},
        to{float(i % 8 + 1) / 9, 1, float(i / 8 % 8 + 1) / 9};
    rays.push_back({from, normalize(to - from)});
  }
  std::vector<Hit> hits(rays.size());
  tracer.intersect(rays, hits);
  int found = 0, differing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit alone;
    found += tracer.intersect(rays[i], alone) && alone.surface < 2;
    differing += hits[i].surface != alone.surface;
  }
  EXPECT_GT(found, 1000);
  EXPECT_LE(differing, 4);
}

TEST(Tracer, TheStaticSurfaceWinsATie) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.1f)), true);
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.9f)), false);
  const Tracer tracer(scene.frame());
  Hit hit;
  ASSERT_TRUE(tracer.intersect({{0.25f, 1, 0.125f}, {0, -1, 0}, 0, INFINITY}, hit));
  EXPECT_EQ(tracer.surface_point(hit).object, 1u);
  const Ray rays[2] = {{{0.25f, 1, 0.125f}, {0, -1, 0}}, {{-0.25f, 1, 0.25f}, {0, -1, 0}}};
  Hit hits[2];
  tracer.intersect(rays, hits);
  for (const Hit& one : hits) EXPECT_EQ(tracer.surface_point(one).object, 1u);
}

/// Heights of the static surface, at most 0 m, and of the topmost surface, where vertical rays meet them: one ray
/// starts at .5 m, below the mover, the other at 5 m. Rounded to 2^-18 m: distances of up to 6 m are exact to a few
/// units of the last place, 5e-7 m, and half a step is four of these. NaN if a ray meets nothing.
std::array<float, 2> heights(const Tracer& tracer) {
  const auto height_below = [&](float start) {
    Hit hit;
    if (!tracer.intersect({{0.25f, start, 0.125f}, {0, -1, 0}, 0, INFINITY}, hit)) return NAN;
    return std::round((start - hit.t) * 0x1p18f) * 0x1p-18f;
  };
  return {height_below(0.5f), height_below(5)};
}

SceneFrame with_height(SceneFrame frame, std::size_t surface, float y) {
  std::vector<Vec3> positions(frame.surfaces[surface].positions.begin(), frame.surfaces[surface].positions.end());
  for (Vec3& p : positions) p.y = y;
  frame.surfaces[surface].positions = std::move(positions);
  return frame;
}

TEST(Tracer, WhatStandsIsTakenFromTheFrameBefore) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.1f)));
  scene.add_quad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, matte(Rgb(0.9f)), true);
  using Heights = std::array<float, 2>;
  StaticTree standing;
  const SceneFrame first = scene.frame(), second = with_height(first, 1, 2);
  const Tracer a(first, standing), b(second, standing);
  EXPECT_EQ(heights(b), (Heights{0, 2}));
  EXPECT_EQ(heights(a), (Heights{0, 1}));               // still its own
  const SceneFrame lower = with_height(second, 0, -1);  // other arrays, as in another segment
  EXPECT_EQ(heights(Tracer(lower, standing)), (Heights{-1, 2}));
  SceneFrame none = second;
  none.surfaces.erase(none.surfaces.begin());
  none.static_count = 0;
  const Heights alone = heights(Tracer(none, standing));
  EXPECT_TRUE(std::isnan(alone[0]));
  EXPECT_EQ(alone[1], 2);
  EXPECT_EQ(heights(Tracer(second, standing)), (Heights{0, 2}));
}

TEST(Tracer, AlphaIsThatOfTheFrameWhereTheTreeIsShared) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.1f)));
  const SceneFrame solid = scene.frame();
  auto hidden = std::make_unique<SceneFrame>(solid);
  hidden->materials[0].alpha_mode = Material::Alpha::mask;
  hidden->materials[0].alpha = 0;
  StaticTree standing;
  EXPECT_EQ(heights(Tracer(solid, standing))[0], 0);
  EXPECT_TRUE(std::isnan(heights(Tracer(*hidden, standing))[0]));
  hidden.reset();  // the shared tree must not ask this frame any more
  EXPECT_EQ(heights(Tracer(solid, standing))[0], 0);
}

TEST(Tracer, RaysThatAreNotFiniteAreMissesAndCounted) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = INFINITY;
  const Ray bad[] = {{{nan, 0, 0}, {1, 0, 0}, 0, inf},   {{0, 0, 0}, {nan, 0, 0}, 0, inf},
                     {{0, 0, 0}, {inf, 0, 0}, 0, inf},   {{0, 0, 0}, {1, 0, 0}, -1, inf},
                     {{0, 0, 0}, {1, 0, 0}, nan, inf},   {{0, 0, 0}, {1, 0, 0}, 0, nan},
                     {{1e30f, 0, 0}, {1, 0, 0}, 0, inf}, {{0, 0, 0}, {1e30f, 0, 0}, 0, inf}};
  for (const Ray& ray : bad) {
    Hit hit;
    EXPECT_FALSE(tracer.intersect(ray, hit));
    EXPECT_TRUE(tracer.occluded(ray));
  }
  EXPECT_EQ(tracer.refused_ray_count(), 2 * std::size(bad));
}

/// At every scale and offset, a ray that leaves a wall of a closed room meets another wall, and never its own wall or
/// none: no self hits, no leaks at edges.
TEST(Tracer, ARoomIsClosedAtEveryScale) {
  for (float scale : {1e-4f, 1.0f, 1e6f}) {
    HandMadeScene scene;
    scene.add_room(Vec3{-1, -1.5f, -2} * scale, Vec3{1, 1.5f, 2} * scale, matte(Rgb(0.5f)));
    const SceneFrame& frame = scene.frame();
    const Tracer tracer(frame);
    const test::AreaSampler area(frame);
    int lost = 0, own = 0;
    constexpr int kRays = 200000;
    for (std::uint32_t i = 0; i < kRays; ++i) {
      const PathRandom random(5, i);
      Vec3 position, normal;
      area.sample(random.get1(0, Purpose::test), random.get2(1, Purpose::test), position, normal);
      SurfacePoint from;
      from.position = position;
      from.normal_geometric = from.normal = normal;
      from.offset = 0x1p-20f * 2 * scale;
      const Vec3 travel = Frame(normal).to_world(sample_hemisphere_cos(random.get2(2, Purpose::test)));
      Hit hit;
      if (!tracer.intersect(spawn_ray(from, travel), hit)) {
        ++lost;
        continue;
      }
      const SurfacePoint to = tracer.surface_point(hit);
      own += dot(to.normal_geometric, normal) > 0.5f;  // the same wall
    }
    EXPECT_EQ(lost, 0) << scale;
    EXPECT_EQ(own, 0) << scale;
  }
}

/// Rays aimed exactly at the edges of a long room, and rays that leave the points they meet. Rounding must not put
/// such a point behind the neighbouring wall, from where the next ray would leave the room.
TEST(Tracer, WhatLeavesAnEdgeStaysInTheRoom) {
  HandMadeScene scene;
  scene.add_room({-5, -0.5f, -0.5f}, {5, 0.5f, 0.5f}, matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  int lost = 0;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const PathRandom random(9, i);
    const Vec2 u = random.get2(0, Purpose::test);
    const float sx = i & 1 ? 5.0f : -5.0f, sy = i & 2 ? 0.5f : -0.5f;
    const Vec3 edge = i % 3 == 0   ? Vec3{sx, sy, u.x - 0.5f}
                      : i % 3 == 1 ? Vec3{sx, u.x - 0.5f, sy}
                                   : Vec3{10 * u.x - 5, sy, i & 1 ? 0.5f : -0.5f};
    const Vec3 from = Vec3{9 * u.y - 4.5f, 0.9f * random.get1(1, Purpose::test) - 0.45f,
                           0.9f * random.get1(2, Purpose::test) - 0.45f};
    Hit hit;
    if (!tracer.intersect({from, edge - from, 0, INFINITY}, hit)) {
      ++lost;
      continue;
    }
    const SurfacePoint point = tracer.surface_point(hit);
    const Vec3 inwards =
        dot(point.normal_geometric, from - point.position) < 0 ? -point.normal_geometric : point.normal_geometric;
    const Vec3 travel = Frame(inwards).to_world(sample_hemisphere_cos(random.get2(3, Purpose::test)));
    lost += !tracer.intersect(spawn_ray(point, travel), hit);
  }
  EXPECT_EQ(lost, 0);
}

TEST(Tracer, AShadowRayIsFreeBetweenTwoWallsAndBlockedByAThird) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
  scene.add_quad({-0.5f, 0, 0.5f}, {0.5f, 0, 0.5f}, {0.5f, 0, -0.5f}, {-0.5f, 0, -0.5f}, matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  Hit hit;
  ASSERT_TRUE(tracer.intersect({{0.75f, 0, 0.7f}, {0, -1, 0}, 0, INFINITY}, hit));
  const SurfacePoint floor = tracer.surface_point(hit);
  EXPECT_FALSE(tracer.occluded(spawn_shadow_ray(floor, {0.7f, 1, 0.7f}, 1e-6f)));
  ASSERT_TRUE(tracer.intersect({{0.25f, -0.5f, 0.1f}, {0, -1, 0}, 0, INFINITY}, hit));
  EXPECT_TRUE(tracer.occluded(spawn_shadow_ray(tracer.surface_point(hit), {0.2f, 1, 0.1f}, 1e-6f)));
}

/// A room of many triangles twice: as one surface, and as an instance of the same primitive with the same transform.
struct TwoRooms {
  static constexpr std::uint32_t kCells = 24;
  Primitive primitive;
  SceneFrame copy, instance;

  explicit TwoRooms(const Affine& transform) {
    const auto corner = [&](Vec3 o, Vec3 x, Vec3 y) {  // a wall of cells, front to x cross y
      const auto first = std::uint32_t(primitive.positions.size());
      for (std::uint32_t j = 0; j <= kCells; ++j)
        for (std::uint32_t i = 0; i <= kCells; ++i)
          primitive.positions.push_back(o + x * (float(i) / kCells) + y * (float(j) / kCells));
      for (std::uint32_t j = 0; j < kCells; ++j)
        for (std::uint32_t i = 0; i < kCells; ++i) {
          const std::uint32_t a = first + j * (kCells + 1) + i, b = a + kCells + 1;
          primitive.triangles.push_back({a, a + 1, b + 1});
          primitive.triangles.push_back({a, b + 1, b});
        }
    };
    corner({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), corner({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
    corner({0, 0, 0}, {0, 1, 0}, {0, 0, 1}), corner({1, 0, 0}, {0, 0, 1}, {0, 1, 0});
    corner({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), corner({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
    Surface surface;
    surface.primitive = &primitive;
    surface.scene_from_node = transform;
    surface.flipped = transform.determinant() < 0;
    for (const Vec3& p : primitive.positions) primitive.normals.push_back(normalize(p + Vec3{1, 2, 3}));
    instance.surfaces = {surface};
    std::vector<Vec3> positions, normals;
    for (std::uint32_t v = 0; v < primitive.positions.size(); ++v) {
      positions.push_back(surface.position(v));
      normals.push_back(surface.normal(v));
      instance.bounds.add(positions.back());
    }
    surface.positions = positions;
    surface.normals = normals;
    copy.surfaces = {surface};
    copy.bounds = instance.bounds;
    copy.static_count = instance.static_count = 1;
    copy.materials = instance.materials = {matte(Rgb(0.5f))};
  }
};

std::vector<Affine> transforms() {
  const double h = std::sqrt(0.5);
  return {affine_from_trs({0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}), affine_from_trs({7, -30, 2}, {h, 0, 0, h}, {3, 3, 3}),
          affine_from_trs({60, 5, -20}, {0.5, 0.5, 0.5, 0.5}, {-1, 2, 8}),
          affine_from_trs({-3, 2, 1}, {0.2, -0.4, 0.4, 0.8}, {0.01, 0.02, 0.01})};  // as far as Sharing lets it be
}

TEST(Tracer, AnInstanceIsTheSameSurfaceAsACopy) {
  for (const Affine& transform : transforms()) {
    const TwoRooms rooms(transform);
    const Tracer copy(rooms.copy), instance(rooms.instance);
    const float size = rooms.copy.bounds.diagonal();
    int differing = 0;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const Vec3 inside = Vec3(transform.point(Vec3d(random_point(i, 0, 0.9f) + Vec3{0.5f, 0.5f, 0.5f})));
      const Ray ray{inside, normalize(random_point(i, 1, 1)), 0, INFINITY};
      Hit a, b;
      ASSERT_TRUE(copy.intersect(ray, a) && instance.intersect(ray, b));
      EXPECT_TRUE(instance.occluded(ray));
      const SurfacePoint p = copy.surface_point(a), q = instance.surface_point(b), r = instance.surface_point(a);
      // the same hit gives the same point to the last bit; a hit found in the instance's space differs by a few ulp
      EXPECT_TRUE(p.position == r.position && p.normal == r.normal && p.normal_geometric == r.normal_geometric);
      differing += a.triangle != b.triangle;
      if (a.triangle == b.triangle) {
        EXPECT_LT(length(p.position - q.position), 1e-5f * size + 1e-6f * length(inside));
      }
    }
    EXPECT_LE(differing, 100) << size;  // rays along edges
  }
}

/// What leaves a wall of an instanced room meets another wall: the offset covers the rounding of the transform.
TEST(Tracer, AnInstancedRoomIsClosed) {
  for (const Affine& transform : transforms()) {
    const TwoRooms rooms(transform);
    const Tracer tracer(rooms.instance);
    int lost = 0, own = 0;
    for (std::uint32_t i = 0; i < 100000; ++i) {
      const PathRandom random(5, i);
      Hit hit{0, 0,
              std::min(std::uint32_t(random.get1(0, Purpose::test) * float(rooms.primitive.triangles.size())),
                       std::uint32_t(rooms.primitive.triangles.size() - 1))};
      const Vec2 b = sample_triangle(random.get2(1, Purpose::test));
      hit.u = b.x, hit.v = b.y;
      const SurfacePoint from = tracer.surface_point(hit);
      const Vec3 travel = Frame(from.normal_geometric).to_world(sample_hemisphere_cos(random.get2(2, Purpose::test)));
      if (!tracer.intersect(spawn_ray(from, travel), hit)) {
        ++lost;
        continue;
      }
      own += dot(tracer.surface_point(hit).normal_geometric, from.normal_geometric) > 0.5f;
    }
    EXPECT_EQ(lost, 0) << rooms.copy.bounds.diagonal();
    EXPECT_EQ(own, 0) << rooms.copy.bounds.diagonal();
  }
}

}  // namespace
}  // namespace tempolux
