// Cells of light and its division in two parts: areas, limits, exact sums.
#include "lib/density/split_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "formats/exact_sum.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

using formats::IrradiancePointRecord;
using formats::Photon;
using formats::PhotonBlock;

constexpr Vec3 kUp{0, 0, 1};

Photon photon(float x, float y, float z, float flux, Vec3 normal = kUp, std::uint16_t object = 1) {
  Photon p;
  p.position = {x, y, z};
  p.flux = {flux, flux, flux};
  p.normal = formats::encode_normal({normal.x, normal.y, normal.z});
  p.object = object;
  return p;
}

/// A floor of 8 x 8 m with `count` photons of flux 1, and `spot` times as many more in the square metre around
/// (2.5, 2.5).
PhotonBlock floor_with_spot(int count, int spot, std::uint64_t seed) {
  const PathRandom random(seed, 0);
  PhotonBlock block;
  for (int i = 0; i < count; ++i) {
    const Vec2 u = random.get2(std::uint32_t(i), Purpose::test);
    block.photons.push_back(photon(8 * u.x, 8 * u.y, 0, 1));
  }
  for (int i = 0; i < spot; ++i) {
    const Vec2 u = random.get2(std::uint32_t(i), Purpose::test, 1);
    block.photons.push_back(photon(2 + u.x, 2 + u.y, 0, 1));
  }
  return block;
}

FluxCells cells_of(const PhotonBlock& block, double edge, double limit) {
  FluxCells cells(edge, 0);
  add_flux(block, cells);
  cells.close(limit);
  return cells;
}

TEST(WindowSum, IsExactInAnyOrderFromDenormalToHuge) {
  std::vector<float> values{1e-45f, 3e38f, 1.0f, 0.5f, 1e-30f, -2.0f, 1e-45f};
  WindowSum forwards, backwards;
  for (float v : values) forwards.add(v);
  std::reverse(values.begin(), values.end());
  for (float v : values) backwards.add(v);
  EXPECT_EQ(forwards.value(), backwards.value());
  WindowSum small;
  for (int i = 0; i < 1000; ++i) small.add(i % 2 ? 0.1f : -0.1f);  // magnitudes count
  EXPECT_EQ(small.value(), 1000 * double(0.1f));                   // exact in a double: 24 + 10 bits
  WindowSum denormal;
  denormal.add(1e-45f);
  EXPECT_EQ(denormal.value(), std::ldexp(1.0, -149));
}

TEST(PlanarHull, AreaOfPointsInASquareAndATriangleIsRightInTheMean) {
  // The mean of 2000 areas, each estimated from 50 points. One estimate deviates by less than 10 % (measured), so the
  // mean by less than .1 / sqrt(2000) = .0023. The band is 3 of these.
  for (const bool triangle : {false, true}) {
    double sum = 0;
    for (int run = 0; run < 2000; ++run) {
      const PathRandom random(7, std::uint64_t(run));
      PlanarHull hull;
      for (int i = 0; i < 50; ++i) {
        Vec2 u = random.get2(std::uint32_t(i), Purpose::test);
        if (triangle && u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
        hull.add(0.25 + 0.5 * double(u.x), 0.25 + 0.5 * double(u.y));
      }
      sum += hull.area();
    }
    EXPECT_NEAR(sum / 2000, triangle ? 0.125 : 0.25, 0.007 * (triangle ? 0.125 : 0.25)) << triangle;
  }
}

TEST(PlanarHull, EightPointsTellTheAreaToAHalf) {
  // Mean square of the relative deviation from the square's area, by 8 and by 4 points. FluxCells leaves cells with
  // fewer than 8 points alone.
  double squares[2]{};
  for (const std::uint32_t count : {8u, 4u})
    for (int run = 0; run < 2000; ++run) {
      const PathRandom random(9, std::uint64_t(run));
      PlanarHull hull;
      for (std::uint32_t i = 0; i < count; ++i) {
        const Vec2 u = random.get2(i, Purpose::test);
        hull.add(0.25 + 0.5 * double(u.x), 0.25 + 0.5 * double(u.y));
      }
      squares[count < 8] += std::pow(hull.area() / 0.25 - 1, 2) / 2000;
    }
  // Measured: .49 and .59. A mean of 2000 squares is known to some per cent.
  EXPECT_LT(std::sqrt(squares[0]), 0.55);
  EXPECT_LT(squares[0], squares[1]);
}

TEST(PlanarHull, DoesNotDependOnOrder) {
  std::vector<Vec2> points;
  const PathRandom random(3, 0);
  for (std::uint32_t i = 0; i < 3000; ++i) points.push_back(random.get2(i, Purpose::test));
  PlanarHull a, b;
  for (Vec2 p : points) a.add(double(p.x), double(p.y));
  std::shuffle(points.begin(), points.end(), std::minstd_rand(1));
  for (Vec2 p : points) b.add(double(p.x), double(p.y));
  EXPECT_EQ(a.area(), b.area());
}

TEST(PlanarHull, PointsOfALineHaveNone) {
  PlanarHull hull;
  EXPECT_EQ(hull.area(), 0);
  for (int i = 0; i < 500; ++i) hull.add(i / 500.0, 0.5);
  EXPECT_EQ(hull.area(), 0);
}

TEST(Divide, PartsAddUpToTheLastBit) {
  const PathRandom random(5, 0);
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const std::uint64_t bits = random.bits(i, Purpose::test);
    const float value = std::bit_cast<float>(std::uint32_t(bits));
    if (!std::isfinite(value)) continue;
    const double share = random.get1(i, Purpose::test, 1);
    const auto part = divide(value, share);
    ASSERT_EQ(double(part.low) + double(part.high), double(value)) << value << " " << share;
    ASSERT_TRUE(part.low * value >= 0 && part.high * value >= 0);
    if (std::abs(value) > 1e-30f) {
      ASSERT_NEAR(double(part.low), share * double(value), 1.2e-7 * std::abs(double(value)));
    }
  }
  for (const float value : {1e-45f, -1e-45f, 1e-38f, 3e38f, 0.0f})
    for (const double share : {0.0, 0.3, 0.5, 0.7, 1.0}) {
      const auto part = divide(value, share);
      EXPECT_EQ(double(part.low) + double(part.high), double(value));
    }
}

TEST(FluxCells, ASpotKeepsItsMultipleOfTheMean) {
  // 20000 photons on 64 m^2 and 20000 more on one of them. Mean irradiance 625, in the spot 20312.
  const PhotonBlock block = floor_with_spot(20000, 20000, 1);
  const FluxCells cells = cells_of(block, 0.5, {4});
  // Each cell's area deviates by less than 10 %, 1 / sqrt(256 cells) of that in the sum.
  EXPECT_NEAR(cells.area(), 64, 64 * 0.02);
  EXPECT_EQ(cells.flux(), 3 * 40000);
  const double kept = cells.low_share({{2.5f, 2.5f, 0}, kUp, 1});
  EXPECT_NEAR(kept, 4 * 625 / 20312.5, 0.2 * 4 * 625 / 20312.5);  // a cell's area and count: 10 % each
  EXPECT_EQ(cells.low_share({{6.5f, 6.5f, 0}, kUp, 1}), 1);
  // The spot's square metre meets 9 cells, whose grid is shifted; no other cell is bright.
  EXPECT_GE(cells.bright_count(), 4u);
  EXPECT_LE(cells.bright_count(), 9u);
}

TEST(FluxCells, OrderAndBlocksDoNotMatter) {
  PhotonBlock block = floor_with_spot(5000, 5000, 2);
  const FluxCells forwards = cells_of(block, 0.5, kBrightLimit);
  std::shuffle(block.photons.begin(), block.photons.end(), std::minstd_rand(1));
  const FluxCells shuffled = cells_of(block, 0.5, kBrightLimit);
  for (const Photon& p : block.photons) ASSERT_EQ(forwards.low_share(place_of(p)), shuffled.low_share(place_of(p)));
  EXPECT_EQ(forwards.area(), shuffled.area());
}

TEST(FluxCells, LimitsZeroAndInfinityAreAllAndNothing) {
  const PhotonBlock block = floor_with_spot(2000, 2000, 3);
  constexpr double inf = std::numeric_limits<double>::infinity();
  const auto all = divide(block, cells_of(block, 0.5, 0));
  EXPECT_EQ(all.high.photons, block.photons);
  EXPECT_TRUE(all.low.photons.empty());
  const auto nothing = divide(block, cells_of(block, 0.5, inf));
  EXPECT_EQ(nothing.low.photons, block.photons);
  EXPECT_TRUE(nothing.high.photons.empty());
}

TEST(FluxCells, SidesAndObjectsAreCellsOfTheirOwn) {
  // A bright and a dark side of one wall, a bright and a dark object on one floor.
  FluxCells cells(1, 0.01);
  for (int i = 0; i < 100; ++i) {
    const float x = float(i % 10) * 0.05f, y = float(i / 10) * 0.05f;
    cells.add({{x, y, 0}, kUp, 1}, {100, 100, 100});
    for (int dark = 0; dark < 30; ++dark) {
      cells.add({{x, y, 0}, -kUp, 1}, {0.1f, 0.1f, 0.1f});
      cells.add({{x, y, 0}, kUp, 2}, {0.1f, 0.1f, 0.1f});
    }
  }
  cells.close({4});
  EXPECT_LT(cells.low_share({{0, 0, 0}, kUp, 1}), 1);
  EXPECT_EQ(cells.low_share({{0, 0, 0}, -kUp, 1}), 1);
  EXPECT_EQ(cells.low_share({{0, 0, 0}, kUp, 2}), 1);
}

TEST(FluxCells, ASurfaceAtZeroIsNotDealtOutToTwoCells) {
  // Heights of a floor at 0 are +-1e-8. Without the grid's shift photons would alternate between two cubes.
  FluxCells cells(1, 0);
  for (int i = 0; i < 400; ++i)
    cells.add({{float(i % 20) * 0.01f, float(i / 20) * 0.01f, i % 2 ? 1e-8f : -1e-8f}, kUp, 1}, {1, 1, 1});
  EXPECT_EQ(cells.size(), 1u);
}

TEST(FluxCells, AllInOnePointAndNothingAreNoError) {
  PhotonBlock block;
  FluxCells none = cells_of(block, 1, kBrightLimit);
  EXPECT_EQ(none.mean_irradiance(), 0);
  for (int i = 0; i < 1000; ++i) block.photons.push_back(photon(1, 2, 3, 1));
  const FluxCells cells = cells_of(block, 1, kBrightLimit);  // no area, no mean: nothing is above it
  EXPECT_EQ(divide(block, cells).low.photons.size() + divide(block, cells).high.photons.size(), 1000u);
  for (Photon& p : block.photons) p.flux = {-1, 0, -2};  // a dynamic map: negative only
  FluxCells hundredth(1, 0.01);                          // with a known area the only cell has the mean irradiance
  add_flux(block, hundredth);
  hundredth.close(0.01);
  const auto parts = divide(block, hundredth);
  EXPECT_EQ(parts.high.photons.size(), 1000u);
  EXPECT_NEAR(parts.low.photons[0].flux[0], -0.01f, 0x1p-24f);  // the larger part's rounding
}

TEST(FluxCells, ReflectedShareMakesDarkSurfacesLessBright) {
  PhotonBlock block = floor_with_spot(5000, 5000, 4);
  for (const Photon& p : block.photons) {
    const bool spot = p.position[0] > 2 && p.position[0] < 3 && p.position[1] > 2 && p.position[1] < 3;
    const std::uint8_t albedo = spot ? 2 : 255;
    block.albedos.push_back({albedo, albedo, albedo, 0});
  }
  EXPECT_EQ(cells_of(block, 0.5, kBrightLimit).bright_count(), 0u);
}

TEST(SplitLight, PhotonsKeepTheirSumAndColumns) {
  PhotonBlock block = floor_with_spot(3000, 6000, 6);
  for (std::size_t i = 0; i < block.photons.size(); ++i) block.directions.push_back({std::uint16_t(i), 7});
  const auto parts = divide(block, cells_of(block, 0.5, {2}));
  formats::ExactRgbSum whole, divided;
  for (const Photon& p : block.photons) whole.add(p.flux);
  for (const PhotonBlock* part : {&parts.low, &parts.high}) {
    ASSERT_EQ(part->photons.size(), part->directions.size());
    for (const Photon& p : part->photons) divided.add(p.flux);
  }
  EXPECT_EQ(whole.rounded(), divided.rounded());
  EXPECT_FALSE(parts.high.photons.empty());
}

// Some photons are in one part only: photons without flux in the low part, all photons in the high part if the limit
// is 0. Directions stay with their photons.
TEST(SplitLight, PartsOfAMapJoinToTheWholeToTheLastBit) {
  PhotonBlock block = floor_with_spot(3000, 6000, 6);
  for (std::size_t i = 0; i < block.photons.size(); ++i) block.directions.push_back({std::uint16_t(i), 7});
  block.photons[5].flux = {0, 0, 0};
  block.photons[7] = block.photons[6];  // two photons that differ in nothing
  block.directions[7] = block.directions[6];
  for (const double limit : {2.0, 0.0, 1e9}) {
    const auto parts = divide(block, cells_of(block, 0.5, limit));
    formats::PhotonMap low, high;
    low.photons = parts.low.photons, low.directions = parts.low.directions;
    high.photons = parts.high.photons, high.directions = parts.high.directions;
    low.header.part = "low";
    join_parts(low, high);
    EXPECT_EQ(low.header.part, "");
    ASSERT_EQ(low.photons.size(), block.photons.size());
    std::vector<std::tuple<std::uint16_t, std::array<float, 3>, std::array<float, 3>>> whole, joined;
    for (std::size_t i = 0; i < block.photons.size(); ++i) {
      whole.emplace_back(block.directions[i][0], block.photons[i].position, block.photons[i].flux);
      joined.emplace_back(low.directions[i][0], low.photons[i].position, low.photons[i].flux);
    }
    std::ranges::sort(whole), std::ranges::sort(joined);
    EXPECT_EQ(whole, joined);
  }
}

TEST(SplitLight, PointsOfABrightPatchAreDividedInProportion) {
  // 100 points of spacing .1 m, 99 of irradiance 1 and a patch of irradiance 100 in one cell.
  std::vector<IrradiancePointRecord> points(116);
  for (std::size_t i = 0; i < points.size(); ++i) {
    IrradiancePointRecord& p = points[i];
    const bool bright = i >= 100;
    p.position = bright ? std::array<float, 3>{5.2f, 5.2f, 0} : std::array<float, 3>{float(i % 10), float(i / 10), 0};
    p.normal = formats::encode_normal({0, 0, 1});
    p.direct = {bright ? 60.0f : 1.0f, 0, 0};
    p.indirect = {bright ? 40.0f : 0.0f, 0, 0};
  }
  FluxCells cells(0.4, 0.01);
  add_flux(points, 0.01, cells);
  cells.close({4});
  const double mean = (100 + 16 * 100) / 116.0;
  EXPECT_NEAR(cells.mean_irradiance(), mean, 1e-5 * mean);  // floats of the products
  const auto parts = divide(points, cells);
  EXPECT_EQ(parts.low.size(), 116u);
  ASSERT_EQ(parts.high.size(), 16u);
  std::vector<IrradiancePointRecord> joined = parts.low;
  const std::vector<float> shares = join_parts(joined, parts.high);
  ASSERT_EQ(shares.size(), 116u);
  for (std::size_t i = 0; i < 116; ++i) {
    EXPECT_EQ(joined[i].direct, points[i].direct);
    EXPECT_EQ(joined[i].indirect, points[i].indirect);
    EXPECT_NEAR(double(shares[i]), i < 100 ? 0 : 1 - 4 * mean / 100, 1e-6);
  }
  joined = {parts.low.begin(), parts.low.begin() + 110};
  EXPECT_TRUE(join_parts(joined, parts.high).empty());  // a point that the low part has not
  EXPECT_NEAR(double(parts.low[110].direct[0]), 60 * 4 * mean / 100, 1e-4);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(double(parts.low[100 + i].direct[0]) + double(parts.high[i].direct[0]), 60);
    EXPECT_EQ(double(parts.low[100 + i].indirect[0]) + double(parts.high[i].indirect[0]), 40);
  }
}

TEST(CellEdge, SixteenMeanDistancesOnASurface) {
  // Photons of a floor of 64 m^2: squares of edge e hold 256 of n photons where e = 16 sqrt(64 / n). The search goes
  // in steps of a quarter of an octave, and cells at the border hold fewer photons.
  for (const int count : {10000, 100000}) {
    CellEdge edge, shuffled;
    std::vector<Photon> photons = floor_with_spot(count, 0, 8).photons;
    for (const Photon& p : photons) edge.add(place_of(p).position);
    const double expected = 16 * std::sqrt(64.0 / count);
    EXPECT_GT(edge.edge(), 0.84 * expected);
    EXPECT_LT(edge.edge(), 1.3 * expected);
    std::shuffle(photons.begin(), photons.end(), std::minstd_rand(1));
    for (const Photon& p : photons) shuffled.add(place_of(p).position);
    EXPECT_EQ(edge.edge(), shuffled.edge());
  }
  EXPECT_EQ(CellEdge().edge(), 1);
  CellEdge one;
  for (int i = 0; i < 100000; ++i) one.add({1, 2, 3});
  EXPECT_EQ(one.edge(), 1);
  CellEdge zeros;  // one place under two names
  zeros.add({0, 0, 0});
  zeros.add({-0.0f, 0, 0});
  EXPECT_EQ(zeros.edge(), 1);
}

}  // namespace
}  // namespace tempolux
