// Which cells can see a box: no such cell is left out, for any positions.
#include "lib/temporal/swept_boxes.h"

#include <gtest/gtest.h>

#include <set>

#include "lib/core/random.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

TEST(CellsTowards, HoldEveryCellThatARayThroughTheBoxLiesIn) {
  constexpr int kRings = 7, kSectors = 22;
  int some = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const PathRandom random(1, i);
    const auto number = [&](std::uint32_t which) { return 2 * random.get1(which, Purpose::test) - 1; };
    const Vec3 normal = normalize(Vec3{number(0), number(1), number(2)} + Vec3{0, 1e-3f, 0});
    SurfacePoint from;
    from.position = {number(3), number(4), number(5)};
    from.normal = from.normal_geometric = normal;
    from.offset = 1e-6f;
    const Vec3 centre{number(6), number(7), number(8)},
        half = Vec3{1, 1, 1} * (0.5f * std::abs(number(9) * number(10)));
    const Box3 box{centre - half, centre + half};
    const GatherDirections directions(from, normal, kRings, kSectors, i);
    std::set<std::uint32_t> found;
    CellsTowards(from.position, directions.frame(), box, kRings, kSectors).for_each([&](std::uint32_t c) {
      EXPECT_LT(c, std::uint32_t(kRings * kSectors));
      EXPECT_TRUE(found.insert(c).second);
    });
    for (std::uint32_t c = 0; c < kRings * kSectors; ++c) {
      Ray ray;
      std::uint64_t key = 0;
      ASSERT_TRUE(directions.aim(c, 0, ray, key));
      if (!meets(ray, INFINITY, box)) continue;
      EXPECT_TRUE(found.count(c)) << i << ' ' << c;
      ++some;
    }
  }
  EXPECT_GT(some, 5000);
}

TEST(Meets, ABoxFromOutsideFromInsideAndBeyondTheEnd) {
  const Box3 box{{1, -1, -1}, {2, 1, 1}};
  EXPECT_TRUE(meets({{0, 0, 0}, {1, 0, 0}}, 1.5f, box));
  EXPECT_FALSE(meets({{0, 0, 0}, {1, 0, 0}}, 0.5f, box));
  EXPECT_FALSE(meets({{0, 0, 0}, {-1, 0, 0}}, INFINITY, box));
  EXPECT_TRUE(meets({{1.5f, 0, 0}, {0, 1, 0}}, 1e-6f, box));
  EXPECT_FALSE(meets({{0, 0, 0}, {0, 1, 0}}, INFINITY, box));
}

}  // namespace
}  // namespace tempolux
