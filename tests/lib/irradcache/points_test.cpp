// PointLookup: which point a hit reads.
#include "lib/irradcache/points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"

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

Box3 box(Vec3 lower, Vec3 upper) {
  Box3 bounds;
  bounds.add(lower);
  bounds.add(upper);
  return bounds;
}

/// `count` points at random places of the unit square y = 0, facing up; each says its own number.
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
  const PointLookup lookup(points, box({0, 0, 0}, {1, 0, 1}), spacing);
  const PathRandom random(2, 2);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    const Vec3 hit{u.x, 0, u.y};
    float nearest = INFINITY;
    for (const IrradiancePoint& p : points) nearest = std::min(nearest, length(p.position - hit));
    const PointLight* read = lookup.find(hit, {0, 1, 0}, 0);
    ASSERT_NE(read, nullptr);
    // The nearest to the middle of the hit's cell (side spacing / 1.4) may be farther by the cell's diagonal.
    EXPECT_LE(length(points[read->point].position - hit), nearest + 1.7321f * spacing / 1.4f + 1e-6f);
    EXPECT_EQ(read->total().g, points[read->point].indirect.g);
  }
}

/// A spot of 1000 on a square of 1: points within 2.5 spacings across its edge are not to be read from anywhere, those
/// farther away are, and so are all of a spot of 5, and of one half as bright on one of 1000 everywhere.
TEST(PointLookup, WhatLiesAtTheEdgeOfAHotSpotIsNotReadFromAfar) {
  constexpr float kSpacing = 0.01f, kSpot = 0.05f;
  const auto infinite_at = [](float spot, float rest, Vec3 hit) {
    std::vector<IrradiancePoint> points;
    for (int i = 0; i < 100; ++i)
      for (int j = 0; j < 100; ++j) {
        const Vec3 place{(float(i) + 0.5f) * kSpacing, 0, (float(j) + 0.5f) * kSpacing};
        points.push_back(point_at(place, {0, 1, 0}, 0, std::max(place.x, place.z) < kSpot ? spot : rest));
        points.back().radius = 0.02f;
      }
    const PointLookup lookup(points, box({0, 0, 0}, {1, 0, 1}), kSpacing);
    return std::isinf(lookup.find(hit, {0, 1, 0}, 0)->radius);
  };
  EXPECT_TRUE(infinite_at(1000, 1, {0.056f, 0, 0.02f}));    // just outside
  EXPECT_TRUE(infinite_at(1000, 1, {0.044f, 0, 0.02f}));    // just inside
  EXPECT_FALSE(infinite_at(1000, 1, {0.015f, 0, 0.015f}));  // in the middle
  EXPECT_FALSE(infinite_at(1000, 1, {0.11f, 0, 0.02f}));
  EXPECT_FALSE(infinite_at(5, 1, {0.056f, 0, 0.02f}));
  EXPECT_FALSE(infinite_at(500, 1000, {0.056f, 0, 0.02f}));
}

/// Points known by a few shadow rays: of those in the light half say 0.1, half 1.9, drawn for each; all beside the shadow of a
/// grid are dark, and so are those of a sheet 1 mm below, which faces the same way. Hits at marked points sample their light, 0 or
/// 1: in the mean hits in the light must get 1. Of 10000 points at most all are read, 0.9 / sqrt(10000) = 0.9 % is their
/// standard deviation. Were points marked by what they say themselves (brighter than the mean, with a dark one beside), those of
/// 1.9 would be sampled and those of 0.1 read: 0.55.
TEST(PointLookup, APointsOwnLightHasNoSayInWhetherItIsRead) {
  constexpr float kSpacing = 0.01f;
  const PathRandom random(7, 7);
  for (const bool sheets : {false, true}) {
    std::vector<IrradiancePoint> points = square(10000);
    const auto is_lit = [&](const IrradiancePoint& p) {
      return p.position.y == 0 && (sheets || (int(p.position.x / (5 * kSpacing)) + int(p.position.z / (5 * kSpacing))) % 2 == 0);
    };
    if (sheets)
      for (std::size_t i = 0; i < 10000; ++i) points.push_back(point_at(points[i].position - Vec3{0, 0.001f, 0}, {0, 1, 0}, 0, 0));
    double mean = 0, lit = 0, marked = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      points[i].indirect = Rgb(0.0f);
      if (is_lit(points[i])) points[i].direct = Rgb(random.get1(i, Purpose::test) < 0.5f ? 0.1f : 1.9f);
    }
    const PointLookup lookup(points, box({0, -0.001f, 0}, {1, 0, 1}), kSpacing);
    for (const IrradiancePoint& p : points) {
      if (!is_lit(p)) continue;
      const PointLight* read = lookup.find(p.position, {0, 1, 0}, 0);
      ASSERT_NE(read, nullptr);
      if (!is_lit(points[read->point])) continue;   // another's cell
      ++lit;
      marked += read->shadow_edge;
      mean += read->shadow_edge ? 1.0 : double(read->all.g);
    }
    EXPECT_NEAR(mean / lit, 1, 0.03) << sheets;
    EXPECT_GT(marked, 0.3 * lit) << sheets;   // there are such edges
  }
}

/// Two sheets 1 mm apart that face away from each other, and one that is seen from both sides.
TEST(PointLookup, SidesAreNeverMixedUp) {
  std::vector<IrradiancePoint> points = square(400);
  for (std::uint32_t i = 0; i < 400; ++i)
    points.push_back(point_at(points[i].position - Vec3{0, 0.001f, 0}, {0, -1, 0}, 0, -1));
  const PointLookup lookup(points, box({0, -0.001f, 0}, {1, 0, 1}), 0.05f);
  const PathRandom random(3, 3);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    EXPECT_GE(lookup.find({u.x, 0, u.y}, {0, 1, 0}, 0)->all.g, 0);
    EXPECT_EQ(lookup.find({u.x, -0.001f, u.y}, {0, -1, 0}, 0)->all.g, -1);
  }
  EXPECT_EQ(PointLookup(std::span(points).first(400), box({0, 0, 0}, {1, 0, 1}), 0.05f)
                .find({0.5f, 0, 0.5f}, {0, -1, 0}, 0),
            nullptr);
}

/// Normals all around a sphere: a direction's bin and its middle are less than 60 degrees apart, so that a
/// point with the hit's own normal is always found.
TEST(PointLookup, EveryDirectionFindsAPointThatFacesIt) {
  const PathRandom random(4, 4);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const Vec3 n = sample_sphere(random.get2(i, Purpose::test));
    const std::vector<IrradiancePoint> points{point_at({0, 0, 0}, n, 0, 1)};
    const PointLookup lookup(points, box({-1, -1, -1}, {1, 1, 1}), 1);
    ASSERT_NE(lookup.find({0.1f, 0, 0}, n, 0), nullptr) << n.x << " " << n.y << " " << n.z;
    EXPECT_EQ(lookup.find({0.1f, 0, 0}, -n, 0), nullptr);
  }
}

/// 3000 objects, each with a tile of its own: hits in the middle of a tile read that tile's point, also where
/// a tile of an object whose number is 1024 (or 2048) more lies at the very same place.
TEST(PointLookup, ThousandsOfObjectsAreToldApart) {
  std::vector<IrradiancePoint> points;
  constexpr std::uint32_t kTiles = 1024;
  for (std::uint32_t i = 0; i < 3 * kTiles; ++i)
    points.push_back(point_at({float(i % kTiles % 32), 0, float(i % kTiles / 32)}, {0, 1, 0}, i, float(i)));
  const PointLookup lookup(points, box({0, 0, 0}, {32, 0, 32}), 1);
  for (int round = 0; round < 2; ++round)  // the second round reads what the first remembered
    for (std::uint32_t i = 0; i < 3 * kTiles; ++i)
      ASSERT_EQ(lookup.find(points[i].position + Vec3{0.1f, 0, 0.1f}, {0, 1, 0}, i)->all.g, float(i));
  EXPECT_NE(lookup.find({3, 0, 3}, {0, 1, 0}, 60000), nullptr);  // an object without points reads a near one
}

/// A wall at x = 0.5 between a bright and a dark room on one floor, and a patch of floor under a box: with
/// the reach test no hit reads beyond, without it those within a cell of the wall do.
TEST(PointLookup, NoHitReadsThroughAWall) {
  std::vector<IrradiancePoint> points = square(2000);
  const auto room = [](Vec3 p) { return p.x < 0.5f ? 0.0f : p.x > 0.8f && p.z > 0.8f ? 2.0f : 1.0f; };
  for (IrradiancePoint& p : points) p.indirect = Rgb(room(p.position));
  const ReachTest reach = [room](Vec3 from, Vec3, Vec3 to, Vec3) { return room(from) == room(to); };
  const Box3 bounds = box({0, 0, 0}, {1, 0, 1});
  const float spacing = std::sqrt(1.0f / 2000);
  const PointLookup open(points, bounds, spacing), walled(points, bounds, spacing, reach);
  const PathRandom random(5, 5);
  int wrong_open = 0, wrong_walled = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    const Vec3 hit{u.x, 0, u.y};
    wrong_open += open.find(hit, {0, 1, 0}, 0)->all.g != room(hit);
    wrong_walled += walled.find(hit, {0, 1, 0}, 0)->all.g != room(hit);
  }
  EXPECT_GT(wrong_open, 100);  // about 1.4 m of wall x half a cell
  EXPECT_EQ(wrong_walled, 0);
}

TEST(PointLookup, AnswersDoNotDependOnThreadsOrOrder) {
  const std::vector<IrradiancePoint> points = square(5000, 7);
  const Box3 bounds = box({0, 0, 0}, {1, 0, 1});
  const PathRandom random(6, 6);
  const auto hit = [&](std::size_t i) {
    const Vec2 u = random.get2(std::uint32_t(i), Purpose::test);
    return Vec3{u.x, 0, u.y};
  };
  constexpr std::size_t kHits = 50000;
  std::vector<std::uint32_t> expected(kHits), answers(kHits);
  const PointLookup forwards(points, bounds, 0.014f), backwards(points, bounds, 0.014f);
  for (std::size_t i = 0; i < kHits; ++i)
    expected[i] = forwards.find(hit(i), {0, 1, 0}, std::uint32_t(i % 7))->point;
  parallel_chunks(kHits, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t j = kHits - 1 - i;
      answers[j] = backwards.find(hit(j), {0, 1, 0}, std::uint32_t(j % 7))->point;
    }
  });
  EXPECT_EQ(answers, expected);
}

/// Places outside the bounds, empty bounds, no points, a spacing far below what coordinates can tell.
TEST(PointLookup, OddInputsAreAnswered) {
  const std::vector<IrradiancePoint> points{point_at({0, 0, 0}, {0, 1, 0}, 5, 1)};
  for (float spacing : {1e-20f, 1.0f, 1e20f}) {
    const PointLookup lookup(points, box({-1, 0, -1}, {1, 0, 1}), spacing);
    EXPECT_NE(lookup.find({1e9f, -1e9f, 0}, {0, 1, 0}, 5), nullptr);
    EXPECT_NE(lookup.find({0, 0, 0}, {0, 1, 0}, 0), nullptr);
  }
  EXPECT_NE(PointLookup(points, Box3{}, 1).find({0, 0, 0}, {0, 1, 0}, 5), nullptr);
  EXPECT_EQ(PointLookup({}, Box3{}, 1).find({0, 0, 0}, {0, 1, 0}, 5), nullptr);
}

}  // namespace
}  // namespace tempolux
