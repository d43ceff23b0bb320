#include <gtest/gtest.h>

#include "formats/irradcache/summary.h"
#include "formats/irradpoints/summary.h"

namespace tempolux::formats {
namespace {

IrradpointsFile two_points() {
  IrradpointsFile file;
  file.header.origin = {10, 0, 0};
  file.header.spacing = 0.5;
  IrradiancePointRecord a, b;
  a.position = {1, 2, 3};
  a.object = 4;
  a.direct = {1, 2, 4};
  a.radius = 0.25f;
  b.position = {-1, 0, 3};
  b.object = 5;
  b.set = SurfaceSet::dynamic_set;
  b.direct = {3, 0, 0};
  file.records = {a, b};
  file.totals = {2, {4, 2, 4}, {}, {}};
  return file;
}

// Two points of 0.5^2 m^2 each: flux = 0.25 * sum.
TEST(IrradSummary, PointsAreCountedAndTheirFluxIsSumTimesArea) {
  const IrradpointsSummary s = summarise(two_points());
  EXPECT_EQ(s.points.count, 2u);
  EXPECT_EQ(s.points.by_set, (std::array<std::uint64_t, 2>{1, 1}));
  EXPECT_EQ(s.points.by_object.at(5), 1u);
  EXPECT_EQ(s.points.position[0].min, 9);
  EXPECT_EQ(s.points.position[0].max, 11);
  EXPECT_EQ(s.direct.flux, (std::array<double, 3>{1, 0.5, 1}));
  EXPECT_EQ(s.direct.irradiance[0].mean(), 2);
  EXPECT_EQ(s.direct.irradiance[2].max, 4);
  EXPECT_EQ(s.indirect.flux, (std::array<double, 3>{}));
  EXPECT_EQ(s.radius.count, 1u);
  EXPECT_EQ(s.radius.mean(), 0.25);
}

TEST(IrradSummary, RecordsAreCountedAndInfiniteRadiiLeftOut) {
  IrradcacheFile file;
  IrradianceCacheRecord a, b;
  a.irradiance = {1, 0, 0};
  a.radius_unclamped = 3;
  b.irradiance = {2, 0, 0};
  b.radius = 2;
  b.radius_unclamped = std::numeric_limits<float>::infinity();
  file.records = {a, b};
  const IrradcacheSummary s = summarise(file);
  EXPECT_EQ(s.records.count, 2u);
  EXPECT_EQ(s.records.by_object.at(0xffff), 2u);
  EXPECT_EQ(s.irradiance[0].mean(), 1.5);
  EXPECT_EQ(s.radius.mean(), 1.5);
  EXPECT_EQ(s.radius_unclamped.count, 1u);
  EXPECT_EQ(s.radius_unclamped.mean(), 3);
  EXPECT_EQ(s.influence.count, 0u);
}

TEST(IrradSummary, OfNothingIsNothing) {
  EXPECT_EQ(summarise(IrradpointsFile()).points.count, 0u);
  EXPECT_EQ(summarise(IrradcacheFile()).radius.mean(), 0);
}

}  // namespace
}  // namespace tempolux::formats
