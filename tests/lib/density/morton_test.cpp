#include "lib/density/morton.h"

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

std::vector<Vec3> random_points(std::size_t count, Vec3 size) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 u = PathRandom(1, i).get2(0, Purpose::test), v = PathRandom(1, i).get2(1, Purpose::test);
    points.push_back({size.x * u.x, size.y * u.y, size.z * v.x});
  }
  return points;
}

TEST(MortonOrder, VisitsEveryPointOnce) {
  const std::vector<std::uint32_t> order = morton_order(random_points(100000, {1, 2, 3}));
  std::vector<bool> seen(order.size());
  for (std::uint32_t i : order) {
    ASSERT_LT(i, seen.size());
    ASSERT_FALSE(seen[i]);
    seen[i] = true;
  }
}

TEST(MortonOrder, FollowsTheCurveOnASmallSquare) {
  // The four corners of a square, z before x before y at each level of the curve as x gets the first bit.
  const std::vector<Vec3> corners{{1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(morton_order(corners), (std::vector<std::uint32_t>{3, 1, 2, 0}));
}

TEST(MortonOrder, MakesStepsShortInFlatAndLongBoxesToo) {
  // n points spread over an area A: the shortest possible mean step is about 0.7 sqrt(A/n), that of a Morton
  // curve about twice that; a random order on the unit square has 0.52. Along a line of length 1: 1/n.
  struct Case {
    Vec3 size;
    double limit;
  };
  const std::size_t n = 40000;
  for (const Case& c : {Case{{1, 1, 0}, 2.5 / std::sqrt(n)}, Case{{0, 1, 1}, 2.5 / std::sqrt(n)},
                        Case{{100, 0.01f, 0}, 2.5 / std::sqrt(n)}, Case{{1, 0, 0}, 1.1 / n}}) {
    const std::vector<Vec3> points = random_points(n, c.size);
    const std::vector<std::uint32_t> order = morton_order(points);
    double sum = 0;
    for (std::size_t i = 1; i < n; ++i) sum += length(points[order[i]] - points[order[i - 1]]);
    EXPECT_LT(sum / double(n - 1), c.limit) << c.size.x << " " << c.size.y;
  }
}

TEST(MortonOrder, KeepsEqualPointsInOrderAndPutsThoseThatAreNotFiniteFirst) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3> points{{1, 1, 1}, {0, 0, 1}, {1, 1, 1}, {nan, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(morton_order(points), (std::vector<std::uint32_t>{1, 3, 0, 2, 4}));
  EXPECT_EQ(morton_order(std::vector<Vec3>(3, Vec3{5, 5, 5})), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(morton_order(std::vector<Vec3>(2, Vec3{nan, nan, nan})), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(morton_order({}).empty());
}

TEST(MortonOrder, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3> points = random_points(100000, {1, 1, 1});
  const std::vector<std::uint32_t> reference = morton_order(points);
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(morton_order(points), reference);
  }
}

}  // namespace
}  // namespace tempolux
