// PointLookup: which point a hit reads.
#include "lib/irradcache/points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

IrradiancePoint point_at(Vec3 position, Vec3 normal, std::uint32_t object, float light) {
  IrradiancePoint point;
  point.position = position;
  point.normal = normal;
  point.object = object;
  point.indirect = Rgb(light);
  return point;
}

/// `count` points at random places of the unit square y = 0, facing up. The light of each is its own number.
std::vector<IrradiancePoint> square(std::uint32_t count, std::uint32_t objects = 1) {
  std::vector<IrradiancePoint> points;
  const PathRandom random(1, 1);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    points.push_back(point_at({u.x, 0, u.y}, {0, 1, 0}, i % objects, float(i)));
  }
  return points;
}

TEST(PointLookup, ReadsAPointNotMuchFartherThanTheNearest) {
  const std::vector<IrradiancePoint> points = square(1000);
  const float spacing = std::sqrt(1.0f / 1000);
  const PointLookup lookup(points, spacing);
  const PathRandom random(2, 2);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    const Vec3 hit{u.x, 0, u.y};
    float nearest = INFINITY;
    for (const IrradiancePoint& p : points) nearest = std::min(nearest, length(p.position - hit));
    const PointLookup::Light* read = lookup.find(hit, {0, 1, 0});
    ASSERT_NE(read, nullptr);
    // The point closest to the middle of the hit's cell (edge spacing / 1.4) may be farther from the hit by the
    // cell's diagonal.
    EXPECT_LE(length(points[read->point].position - hit), nearest + 1.7321f * spacing / 1.4f + 1e-6f);
    EXPECT_EQ(read->all.g, points[read->point].indirect.g);
  }
}

/// Points with few shadow rays: in the light, half of them (at random) have 0.1 and half 1.9. All points in the
/// shadow of a grid are dark, and so are the points of a sheet 1 mm below that faces the same way. Hits at uneven
/// points sample their light, 0 or 1, so hits in the light must get 1 in the mean. At most all of 10000 points are
/// read: the standard error is 0.9 / sqrt(10000) = 0.9 %. If a point's own light decided (brighter than the mean,
/// with a dark neighbour), points of 1.9 would be sampled and points of 0.1 read: 0.55.
TEST(PointLookup, APointsOwnLightHasNoSayInWhetherItIsRead) {
  constexpr float kSpacing = 0.01f;
  const PathRandom random(7, 7);
  for (const bool sheets : {false, true}) {
    std::vector<IrradiancePoint> points = square(10000);
    const auto is_lit = [&](const IrradiancePoint& p) {
      return p.position.y == 0 &&
             (sheets || (int(p.position.x / (5 * kSpacing)) + int(p.position.z / (5 * kSpacing))) % 2 == 0);
    };
    if (sheets)
      for (std::size_t i = 0; i < 10000; ++i)
        points.push_back(point_at(points[i].position - Vec3{0, 0.001f, 0}, {0, 1, 0}, 0, 0));
    double mean = 0, lit = 0, marked = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      points[i].indirect = Rgb(0.0f);
      if (is_lit(points[i])) points[i].direct = Rgb(random.get1(i, Purpose::test) < 0.5f ? 0.1f : 1.9f);
    }
    const PointLookup lookup(points, kSpacing);
    for (const IrradiancePoint& p : points) {
      if (!is_lit(p)) continue;
      const PointLookup::Light* read = lookup.find(p.position, {0, 1, 0});
      ASSERT_NE(read, nullptr);
      if (!is_lit(points[read->point])) continue;  // the point belongs to another cell
      ++lit;
      marked += !lookup.is_uniform(*read);
      mean += !lookup.is_uniform(*read) ? 1.0 : double(read->all.g);
    }
    EXPECT_NEAR(mean / lit, 1, 0.03) << sheets;
    EXPECT_GT(marked, 0.3 * lit) << sheets;  // there are such edges
  }
}

/// Two sheets 1 mm apart that face away from each other, and one that is seen from both sides.
TEST(PointLookup, SidesAreNeverMixedUp) {
  std::vector<IrradiancePoint> points = square(400);
  for (std::uint32_t i = 0; i < 400; ++i)
    points.push_back(point_at(points[i].position - Vec3{0, 0.001f, 0}, {0, -1, 0}, 0, -1));
  const PointLookup lookup(points, 0.05f);
  const PathRandom random(3, 3);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    EXPECT_GE(lookup.find({u.x, 0, u.y}, {0, 1, 0})->all.g, 0);
    EXPECT_EQ(lookup.find({u.x, -0.001f, u.y}, {0, -1, 0})->all.g, -1);
  }
  EXPECT_EQ(PointLookup(std::span(points).first(400), 0.05f).find({0.5f, 0, 0.5f}, {0, -1, 0}), nullptr);
}

/// Normals all around a sphere: the middle of a direction's bin is less than 60 degrees from the direction, so a
/// point with the hit's own normal is always found.
TEST(PointLookup, EveryDirectionFindsAPointThatFacesIt) {
  const PathRandom random(4, 4);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const Vec3 n = test::sample_sphere(random.get2(i, Purpose::test));
    const std::vector<IrradiancePoint> points{point_at({0, 0, 0}, n, 0, 1)};
    const PointLookup lookup(points, 1);
    ASSERT_NE(lookup.find({0.1f, 0, 0}, n), nullptr) << n.x << " " << n.y << " " << n.z;
    EXPECT_EQ(lookup.find({0.1f, 0, 0}, -n), nullptr);
  }
}

/// A wall at x = 0.5 stands between a bright and a dark room on one floor, and a box stands on a patch of the floor.
/// Hits close to the wall read points of their own side or none, and most read one. Seen to fail: points read by their
/// side alone, without a look for walls.
TEST(PointLookup, NoHitReadsThroughAWall) {
  std::vector<IrradiancePoint> points = square(2000);
  const auto room = [](Vec3 p) { return p.x < 0.5f ? 0.0f : p.x > 0.8f && p.z > 0.8f ? 2.0f : 1.0f; };
  for (IrradiancePoint& p : points) p.indirect = Rgb(room(p.position));
  const auto look = [room](Vec3 from, Vec3 normal, float reach) {  // in steps of a thousandth of the reach
    const Frame frame(normal);
    Clearance seen;
    seen.reach = reach;
    for (std::uint32_t k = 0; k < Clearance::kSpokes; ++k) {
      const Vec2 u = Clearance::spoke(k);
      const Vec3 along = frame.tangent * u.x + frame.bitangent * u.y;
      float gone = 0;
      while (gone < reach && room(from + along * gone) == room(from)) gone += reach / 1000;
      seen.set(k, std::max(0.0f, gone - reach / 1000));
    }
    return seen;
  };
  const float spacing = std::sqrt(1.0f / 2000);
  const PointLookup open(points, spacing), walled(points, spacing, look);
  const PathRandom random(5, 5);
  int wrong_open = 0, wrong_walled = 0, none = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    const Vec3 hit{u.x, 0, u.y};
    wrong_open += open.find(hit, {0, 1, 0})->all.g != room(hit);
    const PointLookup::Light* read = walled.find(hit, {0, 1, 0});
    none += !read;
    wrong_walled += read && read->all.g != room(hit);
  }
  EXPECT_GT(wrong_open, 100);  // about 1.4 m of wall x half a cell
  EXPECT_LE(wrong_walled, 4);  // round the patch's corner, where it lies between two spokes
  EXPECT_LT(none, 400);        // of 20000: a strip of a tenth of the spacing on either side of the wall at most
}

/// Two floors 3 mm apart that face the same way, the lower one dark, with points 1 cm apart and unobstructed
/// clearance. Only points within the angle of the spokes are read. So a hit on one floor reads a point of the other
/// only if the point is farther away than 3 mm / 0.05.
TEST(PointLookup, SheetsThatFaceAlikeAreNotMixedUp) {
  std::vector<IrradiancePoint> points = square(10000);
  for (IrradiancePoint& p : points) p.indirect = Rgb(1.0f);
  for (std::uint32_t i = 0; i < 10000; ++i)
    points.push_back(point_at(points[i].position - Vec3{0, 0.003f, 0}, {0, 1, 0}, 0, 0));
  const PointLookup lookup(points, 0.01f, [](Vec3, Vec3, float reach) { return Clearance{reach}; });
  const PathRandom random(3, 4);
  int found = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    for (const float y : {0.0f, -0.003f})
      if (const PointLookup::Light* read = lookup.find({u.x, y, u.y}, {0, 1, 0})) {
        ++found;
        EXPECT_EQ(read->position.y, y);
      }
  }
  EXPECT_GT(found, 3900);
}

TEST(PointLookup, AnswersDoNotDependOnThreadsOrOrder) {
  const std::vector<IrradiancePoint> points = square(5000, 7);
  const PathRandom random(6, 6);
  const auto hit = [&](std::size_t i) {
    const Vec2 u = random.get2(std::uint32_t(i), Purpose::test);
    return Vec3{u.x, 0, u.y};
  };
  constexpr std::size_t kHits = 50000;
  std::vector<std::uint32_t> expected(kHits), answers(kHits);
  const PointLookup forwards(points, 0.014f), backwards(points, 0.014f);
  for (std::size_t i = 0; i < kHits; ++i) expected[i] = forwards.find(hit(i), {0, 1, 0})->point;
  parallel_chunks(kHits, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t j = kHits - 1 - i;
      answers[j] = backwards.find(hit(j), {0, 1, 0})->point;
    }
  });
  EXPECT_EQ(answers, expected);
}

/// Places outside the bounds, empty bounds, no points, and a spacing far below the resolution of coordinates.
TEST(PointLookup, OddInputsAreAnswered) {
  const std::vector<IrradiancePoint> points{point_at({0, 0, 0}, {0, 1, 0}, 5, 1)};
  for (float spacing : {1e-20f, 1.0f, 1e20f}) {
    const PointLookup lookup(points, spacing);
    EXPECT_NE(lookup.find({1e9f, -1e9f, 0}, {0, 1, 0}), nullptr);
    EXPECT_NE(lookup.find({0, 0, 0}, {0, 1, 0}), nullptr);
  }
  EXPECT_NE(PointLookup(points, 1).find({0, 0, 0}, {0, 1, 0}), nullptr);
  EXPECT_EQ(PointLookup({}, 1).find({0, 0, 0}, {0, 1, 0}), nullptr);
}

/// Estimates of 50 photons have an error of 14 %. With E_bright = 1, a photon at the dark place has e = (r_bright /
/// r_dark)^2 / 50. The lines compare three standard errors, 3 sqrt(0.02 + 1024 (E_dark e + e^2)), with 1 - 32 E_dark.
TEST(Points, ContrastCountsWhereItIsMoreThanNoiseOfPhotons) {
  const auto apart = [](float bright_radius, float dark, float dark_radius, float widest = 10) {
    std::vector<IrradiancePoint> points(3);
    for (int i = 0; i < 3; ++i) {
      points[i].position = {float(i), 0, 0};
      points[i].normal = {0, 1, 0};
      points[i].radius = i == 0 ? bright_radius : i == 1 ? dark_radius : widest;
    }
    points[0].indirect = Rgb(1.0f);
    points[1].indirect = Rgb(dark);
    return PointLookup(points, 1).apart(points[0], points[1]);
  };
  EXPECT_TRUE(apart(1, 0, 2));          // e = 0.005: 0.64 < 1
  EXPECT_FALSE(apart(1, 0, 1));         // e = 0.02: 1.97
  EXPECT_FALSE(apart(1, 0.0125f, 2));   // 0.99 > 0.6
  EXPECT_TRUE(apart(1, 0.0125f, 8));    // e = 0.0003: 0.47 < 0.6
  EXPECT_FALSE(apart(1, 0.03125f, 9));  // 32 times, not more
  EXPECT_FALSE(apart(10, 0, 10));       // the bright estimate has an unknown number of photons
}

/// Every second point of a grid has no light, the others the light of 50 photons: 1 against 0 is certainly more than
/// 32 times. A look-up that takes light as uniform does not report it, although it was asked before.
TEST(Points, TakenAsEvenAreNotCompared) {
  std::vector<IrradiancePoint> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back(point_at({float(i % 10), 0, float(i / 10)}, {0, 1, 0}, 0, float(i % 2)));
    points.back().direct = Rgb(float(i % 2));
    points.back().radius = i % 2 ? 1.0f : 10.0f;
  }
  PointLookup lookup(points, 1);
  EXPECT_FALSE(lookup.is_uniform_indirect(lookup.light(44)) || lookup.is_uniform(lookup.light(44)));
  lookup.take_as_even();
  EXPECT_TRUE(lookup.is_uniform_indirect(lookup.light(44)) && lookup.is_uniform(lookup.light(44)));
}

/// Bright points, and close behind them dark points that face the same way. Dark points of another object are the
/// outer leaf of a double wall. Dark points of the same object mark where its light ends.
TEST(Points, TheOtherLeafOfADoubleWallIsNoContrast) {
  for (const bool other : {true, false}) {
    std::vector<IrradiancePoint> points;
    for (int i = 0; i < 5; ++i)
      for (const bool dark : {false, true}) {
        IrradiancePoint point;
        point.position = {float(i), dark ? -1e-4f : 0, 0};
        point.normal = {0, 1, 0};
        point.object = dark && other ? 2 : 1;
        point.radius = dark ? 4 : 1;
        point.indirect = Rgb(dark ? 0.0f : 1.0f);
        points.push_back(point);
      }
    const PointLookup lookup(points, 1);
    EXPECT_EQ(lookup.is_uniform_indirect(lookup.light(4)), other);
  }
}

/// On a wide surface each point has 7 neighbours. A point with no neighbour or one may be the only point of a wall
/// that is half in shadow, so hits on the wall sample its direct light. Seen to fail without this rule: a hut's wall
/// had one point, which was in shadow, and the ground in front of it was 80 % too dark.
TEST(Points, APointAloneShowsNothing) {
  for (const int count : {1, 2, 3, 4}) {
    std::vector<IrradiancePoint> points;
    for (int i = 0; i < count; ++i) points.push_back(point_at({0.5f * float(i), 0, 0}, {0, 1, 0}, 1, 0));
    const PointLookup lookup(points, 1);
    EXPECT_EQ(lookup.is_uniform(lookup.light(0)), count > 2) << count;
    EXPECT_TRUE(lookup.is_uniform_indirect(lookup.light(0))) << count;
  }
}

}  // namespace
}  // namespace tempolux
