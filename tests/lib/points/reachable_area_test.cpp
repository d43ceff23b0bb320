// Area over which light of a place spreads: whole discs, discs cut by an edge or by a wall, against areas on paper.
#include "lib/points/reachable_area.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/pi.h"
#include "tests/support/mean.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using Kernel = ReachableArea::Kernel;

constexpr float kRadius = 0.5f;
constexpr double kDisc = kPiD * double(kRadius) * double(kRadius);

/// A floor from x = -10 to x = 10, at height 0.
struct Floor {
  test::HandMadeScene scene;
  Floor() { scene.add_quad({-10, 0, 10}, {10, 0, 10}, {10, 0, -10}, {-10, 0, -10}, test::matte(Rgb(0.5f))); }
  /// A wall from the floor up, at x = `x`, matte on both sides.
  void add_wall(float x) { scene.add_quad({x, 0, 10}, {x, 0, -10}, {x, 2, -10}, {x, 2, 10}, test::matte(Rgb(0.5f))); }
  /// Area of the disc at x, 1 over the mean of 400 estimates.
  test::Mean inverse(float x, Kernel kernel, int probes) {
    const Tracer tracer(scene.frame());
    const ReachableArea area(tracer);
    test::Mean mean;
    for (std::uint32_t seed = 0; seed < 400; ++seed)
      mean.add(area.inverse({x, 0, 0.013f}, {0, 1, 0}, kRadius, probes, kernel, PathRandom(seed, 0)));
    return mean;
  }
};

/// All columns arrive, so the flat kernel has no noise: 1 / (pi r^2).
TEST(ReachableArea, WholeDisc) {
  Floor floor;
  EXPECT_NEAR(floor.inverse(0, Kernel::flat, 16).mean() * kDisc, 1, 1e-5);
  EXPECT_NEAR(floor.inverse(0, Kernel::round, 16).mean() * kDisc, 1, 1e-5);
}

/// At the edge of the floor half of the columns arrive: 2 / (pi r^2), also weighed by a round kernel. Independent
/// columns until m arrive are exact in the mean. Stratified ones are low by up to 1 / (2 m).
TEST(ReachableArea, HalfADiscAtAnEdge) {
  Floor floor;
  const test::Mean round = floor.inverse(10, Kernel::round, 16);
  EXPECT_NEAR(round.mean() * kDisc, 2, 4 * round.sigma() * kDisc);
  EXPECT_LT(round.sigma() * kDisc, 0.03);
  const test::Mean flat = floor.inverse(10, Kernel::flat, 64);
  EXPECT_NEAR(flat.mean() * kDisc, 2, 4 * flat.sigma() * kDisc + 2.0 / (2 * 64));
}

/// A wall at half the radius cuts off the segment r^2 (acos 1/2 - 1/2 sqrt(3/4)), which does not count though the floor
/// goes on behind the wall. The wall itself stands at 90 degrees to the place and does not count either.
TEST(ReachableArea, DiscCutByAWall) {
  Floor floor;
  floor.add_wall(0.25f);
  const double r = double(kRadius), open = kDisc - r * r * (std::acos(0.5) - 0.5 * std::sqrt(0.75));
  const test::Mean flat = floor.inverse(0, Kernel::flat, 64);
  EXPECT_NEAR(flat.mean() * open, 1, 4 * flat.sigma() * open + 1.0 / (2 * 64));
  EXPECT_LT(open / kDisc, 0.81);  // a disc that is not cut would fail by a fifth
}

/// A disc is whole if its rim has surface and no wall cuts it.
TEST(ReachableArea, IsWholeFarFromWallsAndEdges) {
  Floor floor;
  floor.add_wall(3);
  const Tracer tracer(floor.scene.frame());
  const ReachableArea area(tracer);
  const auto whole = [&](float x) { return area.whole({x, 0, 0.013f}, {0, 1, 0}, kRadius, 0.3f); };
  EXPECT_TRUE(whole(0));
  EXPECT_TRUE(whole(2.4f));
  EXPECT_FALSE(whole(2.75f));
  EXPECT_TRUE(whole(-9.4f));
  EXPECT_FALSE(whole(-9.75f));
}

/// Nothing lies between two places of one side. A wall lies between places on its two sides, and the way over the
/// tangent plane is no way around.
TEST(Reach, StopsAtAWall) {
  Floor floor;
  floor.add_wall(0.25f);
  const Tracer tracer(floor.scene.frame());
  const Reach reach(tracer);
  const Vec3 up{0, 1, 0};
  EXPECT_TRUE(reach({0, 0, 0}, up, {-0.4f, 0, 0.1f}, up));
  EXPECT_FALSE(reach({0, 0, 0}, up, {0.4f, 0, 0.1f}, up));
}

}  // namespace
}  // namespace tempolux
