// Sums of photons in cells, from which photons can be removed exactly, and filters that keep the sum.
#include "lib/compose/fluence_volume.h"

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace tempolux {
namespace {

/// 2 x 2 x 2 cells of majorants over a box of 1 x 1 x 2 m; the last cell is empty.
MajorantGrid majorants() {
  MajorantGrid grid({{0, 0, 0}, {1, 1, 2}}, {2, 2, 2});
  for (float& value : grid.values()) value = 3;
  grid.values().back() = 0;
  return grid;
}

struct Deposit {
  Vec3 at;
  Rgb worth;
};

/// Photons at uniform places of the cells that are not empty.
std::vector<Deposit> deposits(std::size_t count, std::uint64_t seed) {
  std::vector<Deposit> all;
  for (std::uint64_t i = 0; all.size() < count; ++i) {
    const PathRandom random(seed, i);
    const Vec2 xy = random.get2(0, Purpose::test), zw = random.get2(1, Purpose::test);
    const Vec3 at{xy.x, xy.y, 2 * zw.x};
    if (at.x >= 0.5f && at.y >= 0.5f && at.z >= 1) continue;
    all.push_back({at, Rgb(1, 0.3f, 1e-3f) * (1e-4f * (0.5f + zw.y))});
  }
  return all;
}

TEST(FluenceSums, AddingAndTakingAwayAreInverse) {
  const std::vector<Deposit> first = deposits(20000, 1), second = deposits(20000, 2);
  FluenceSums sums(majorants(), 0.1, 5);
  for (const Deposit& d : first) sums.add(d.at, d.worth);
  FluenceSums changed = sums;
  for (const Deposit& d : second) changed.add(d.at, d.worth);
  EXPECT_FALSE(changed == sums);
  for (auto d = second.rbegin(); d != second.rend(); ++d) changed.add(d->at, d->worth, -1);  // in another order
  EXPECT_TRUE(changed == sums);
  FluenceSums replaced = sums;
  for (const Deposit& d : first) replaced.add(d.at, d.worth, -1);
  for (const Deposit& d : second) replaced.add(d.at, d.worth);
  FluenceSums fresh(majorants(), 0.1, 5);
  for (const Deposit& d : second) fresh.add(d.at, d.worth);
  EXPECT_TRUE(replaced == fresh);
}

TEST(FluenceSums, KeepsTheDigitsOfAPhoton) {
  FluenceSums sums(majorants(), 0.1, 100);
  sums.add({0.25f, 0.25f, 0.25f}, Rgb(1e-6f, 0, 0));  // of 100 W through 2.4 m: one of 10^8 photons
  const std::int64_t kept = sums.sums()[sums.cell_of({0.25f, 0.25f, 0.25f})][0];
  EXPECT_NEAR(double(kept) * sums.unit(), 1e-6, 1e-6 * 1e-4);
}

TEST(FluenceSums, OutsideAndNotFiniteCountNothing) {
  FluenceSums sums(majorants(), 0.1, 5);
  const FluenceSums empty = sums;
  sums.add({-0.01f, 0, 0}, Rgb(1.0f));
  sums.add({0, 0, 2.01f}, Rgb(1.0f));
  sums.add({NAN, 0, 0}, Rgb(1.0f));
  sums.add({0.5f, 0.5f, 0.5f}, Rgb(NAN, 1, 1));
  EXPECT_TRUE(sums == empty);
  sums.add({1, 1, 2}, Rgb(1.0f));  // the corner belongs to the last cell
  EXPECT_FALSE(sums == empty);
  EXPECT_TRUE(FluenceSums(MajorantGrid(), 0.1, 5).sums().empty());
}

/// Uniform fluence stays uniform under the filter, also at the border of the empty cell. 400 000 uniform photons in
/// 7/8 of 20 x 20 x 40 cells are 28 per cell. A Gaussian of 2 cells averages 356 of these, a noise of 1 %; at a corner
/// an eighth, 3 %.
TEST(FluenceVolume, EvenLightStaysEven) {
  FluenceSums sums(majorants(), 0.05, 5);
  const std::size_t n = 400000;
  for (const Deposit& d : deposits(n, 3)) sums.add(d.at, Rgb(1.0f / float(n)));
  const double exact = 1 / 1.75;  // 1 W m over 7/4 m^3
  const FluenceVolume volume(sums, 2);
  double mean = 0;
  int places = 0;
  for (float x = 0.01f; x < 1; x += 0.07f)
    for (float y = 0.01f; y < 1; y += 0.07f)
      for (float z = 0.01f; z < 2; z += 0.07f) {
        if (x > 0.49f && y > 0.49f && z > 0.99f) continue;
        const Rgb here = volume.at({x, y, z});
        ASSERT_NEAR(here.r, exact, 0.2 * exact) << x << ' ' << y << ' ' << z;  // 5 deviations at a corner
        mean += double(here.r);
        ++places;
      }
  EXPECT_NEAR(mean / places, exact, 0.01 * exact);
  EXPECT_EQ(volume.at({-0.1f, 0.5f, 0.5f}).r, 0);
}

TEST(FluenceVolume, WidthFollowsTheNumberOfPhotons) {
  FluenceSums few(majorants(), 0.05, 5), many(majorants(), 0.05, 5);
  for (const Deposit& d : deposits(5000, 4)) few.add(d.at, d.worth);
  for (const Deposit& d : deposits(40000, 4)) many.add(d.at, d.worth);
  const float wide = FluenceVolume(few, 0).width(), narrow = FluenceVolume(many, 0).width();
  EXPECT_NEAR(wide / narrow, 2, 1e-3);  // eight times as many photons in half the width
}

}  // namespace
}  // namespace tempolux
