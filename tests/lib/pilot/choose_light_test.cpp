// The cheapest way to light for made-up rough frames.
#include "lib/pilot/choose_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/pilot/spread_work.h"

namespace tempolux {
namespace {

/// Samples that reduce a variance to .1.
double samples(double variance) { return variance / 0.1; }

/// 10^6 pixels; a path costs 10 shadow rays and has a squared error of 2, half of it from indirect light; the wish
/// allows .1.
RoughFrame example() {
  RoughFrame rough;
  rough.places = 2048;
  rough.gathered = rough.recorded = true;
  rough.wanted = 0.1;
  rough.path = {10, 2, 2, 1, 1};
  rough.gather = {8, 1.5, 1.5, 1, 1};
  rough.record_sample = 6;
  rough.records = 10'000;
  rough.record_ray = 10;
  rough.record_error = 1;
  return rough;
}
constexpr Order kOrder{1e6, 0, false};
constexpr double kPoints = 40'000 * Work::kPoint, kRecords = 10'000 * Work::kRecord;
/// Seen errors: of samples with the allowed error, of smooth light, of records with k rays.
const double kSampled = 0.1 * Seen::independent();
double smooth(double error) { return Seen::smooth() * error; }
double seen_of(int rays) { return Seen::kRecords / rays; }

Way way(const std::vector<Way>& ways, IndirectMethod method, bool map = false) {
  for (const Way& one : ways)
    if (one.method == method && one.map == map) return one;
  ADD_FAILURE() << "no such way";
  return {};
}

/// Paths: 10^6 x n(2) x 10. Gathering: n(1.5) of 8, and the points. Records: n(1) of 6, W = 6.26e7 in all with the
/// points and the records' places, and 10^5 per ray. With k rays the score is (W + 1e5 k) (.104 + 2.1 / k), least at
/// k = sqrt(2.1 W / (1e5 x .104)) = 112; the next power of two is 128.
TEST(WaysToLight, CostAndErrAsDerived) {
  const std::vector<Way> ways = ways_to_light(example(), kOrder, false);
  ASSERT_EQ(ways.size(), 3u);
  EXPECT_NEAR(way(ways, IndirectMethod::paths).work, 1e7 * samples(2), 1);
  EXPECT_NEAR(way(ways, IndirectMethod::paths).error, kSampled, 1e-12);
  EXPECT_NEAR(way(ways, IndirectMethod::gather).work, 8e6 * samples(1.5) + kPoints, 1);
  const Way records = way(ways, IndirectMethod::records);
  EXPECT_EQ(records.rays, 128);
  EXPECT_NEAR(records.work, 6e6 * samples(1) + kPoints + kRecords + 1e5 * records.rays, 1);
  EXPECT_NEAR(records.error, kSampled + seen_of(records.rays), 1e-12);
  EXPECT_EQ(ways.front().method, IndirectMethod::records);
}

/// Pictures that share light pay for a part of it: a quarter of the records' work gives them twice the rays, 225, or
/// 256 on the grid. All rays together cost at most as much as one picture's samples, 6e7 / 1e5 = 600 rays, or 512.
TEST(WaysToLight, ChargeAPictureWithItsPartOfTheLight) {
  Order order = kOrder;
  order.pictures = 10;
  order.records = 0.25;
  const std::vector<Way> ways = ways_to_light(example(), order, false);
  EXPECT_NEAR(way(ways, IndirectMethod::gather).work, 8e6 * samples(1.5) + kPoints / 10, 1);
  const Way records = way(ways, IndirectMethod::records);
  EXPECT_EQ(records.rays, 256);
  EXPECT_NEAR(records.work, 6e6 * samples(1) + kPoints / 10 + 0.25 * (kRecords + 1e5 * records.rays), 1);
  order.records = 0.001;
  EXPECT_EQ(way(ways_to_light(example(), order, false), IndirectMethod::records).rays, 512);
}

/// Light that lone samples bring is lacking in the other pixels: the error of .5 of the picture's light is .25. Paths
/// lack both layers, unless a map shows caustic light; records lack caustic light alone.
TEST(WaysToLight, LackWhatLoneSamplesBring) {
  RoughFrame rough = example();
  rough.path.missed_caustic.lone = 0.2;
  rough.path.missed_indirect.lone = 0.3;
  rough.gather.missed_caustic.lone = 0.1;
  const std::vector<Way> ways = ways_to_light(rough, kOrder, true);
  EXPECT_NEAR(way(ways, IndirectMethod::paths).error, kSampled + smooth(0.25), 1e-12);
  EXPECT_NEAR(way(ways, IndirectMethod::paths, true).error, kSampled + smooth(0.09), 1e-12);
  const Way records = way(ways, IndirectMethod::records), with_map = way(ways, IndirectMethod::records, true);
  EXPECT_NEAR(records.error - seen_of(records.rays), kSampled + smooth(0.01), 1e-12);
  EXPECT_NEAR(with_map.error - seen_of(with_map.rays), kSampled, 1e-12);
}

/// Samples n ~ (sigma / e)^(7/8) leave variance^(1 - 7/16) e^(7/8) of noise: twice the variance gives equal noise if e
/// is multiplied by 2^-(9/14), rounded to quarters of powers of two: 2^-(3/4). Records leave no indirect light to the
/// samples, so their frames keep the wish's error.
TEST(WaysToLight, NoisierSamplesNeedAFinerPixelError) {
  RoughFrame rough = example();
  rough.wanted_of = 1;
  const std::vector<Way> ways = ways_to_light(rough, kOrder, false);
  EXPECT_NEAR(way(ways, IndirectMethod::paths).pixel_error, std::pow(2, -0.75), 1e-12);
  EXPECT_EQ(way(ways, IndirectMethod::records).pixel_error, 1);
}

/// A filter that leaves 1/2.4 of the samples' squared error leaves that of records. What it leaves is seen 1.24 / 1.04
/// times as much in wide boxes. So records that err twice as much get (2.4 x 1.04 / 1.24)^(1/2) times the rays: 159
/// become 226, and 256 instead of 128 on the grid.
TEST(WaysToLight, AFilterHelpsSamplesAlone) {
  RoughFrame rough = example();
  rough.record_error = 2;
  EXPECT_EQ(way(ways_to_light(rough, kOrder, false), IndirectMethod::records).rays, 128);
  const std::vector<Way> ways = ways_to_light(rough, {1e6, 0}, false);
  const double filtered = 0.1 / 2.4 * Seen::kSamples;
  EXPECT_NEAR(way(ways, IndirectMethod::paths).error, filtered, 1e-12);
  const Way records = way(ways, IndirectMethod::records);
  EXPECT_EQ(records.rays, 256);
  EXPECT_NEAR(records.error, filtered + 2 * seen_of(records.rays), 1e-12);
}

/// Ways that were not measured are reported as lower bounds ("at least").
TEST(WaysToLight, SayWhatWasNotMeasured) {
  RoughFrame rough = example();
  rough.recorded = false;
  const std::vector<Way> ways = ways_to_light(rough, kOrder, false);
  EXPECT_TRUE(way(ways, IndirectMethod::gather).measured);
  EXPECT_FALSE(way(ways, IndirectMethod::records).measured);
  EXPECT_NE(because(ways).find("records at least"), std::string::npos);
  EXPECT_FALSE(way(joined({ways, ways_to_light(example(), kOrder, false)}), IndirectMethod::records).measured);
}

/// No other number of rays has a score that is lower by more than the grid costs, a factor of (2 + 2^.5 + 2^-.5) / 4:
/// sqrt(2100 x 6.26e7 / 1.04e4) = 3550 rays of records that err that much, 4096 on the grid.
TEST(WaysToLight, RecordsHaveTheBestNumberOfRays) {
  RoughFrame rough = example();
  rough.record_error = 1000;
  const Way best = way(ways_to_light(rough, kOrder, false), IndirectMethod::records);
  EXPECT_EQ(best.rays, 4096);
  for (int rays = 64; rays <= 9000; ++rays) {
    const double work = 6e6 * samples(1) + kPoints + kRecords + 1e5 * rays;
    const Way other{IndirectMethod::records, false, rays, work, kSampled + 1000 * seen_of(rays)};
    EXPECT_GE(1.0304 * other.score(), best.score()) << rays;
  }
}

/// Without indirect light no way to find it pays. Where indirect light is most of the noise records pay, but not in a
/// small picture.
TEST(WaysToLight, FollowTheIndirectLight) {
  RoughFrame rough = example();
  rough.path = {10, 1, 1, 1, 1};
  rough.gather = {8, 1, 1, 1, 1};
  rough.record_error = 0;
  rough.record_sample = 10;
  EXPECT_EQ(ways_to_light(rough, kOrder, false).front().method, IndirectMethod::gather)
      << "a sample of it is cheaper here";
  rough.gather.work = 10;
  EXPECT_EQ(ways_to_light(rough, kOrder, false).front().method, IndirectMethod::paths);
  EXPECT_EQ(ways_to_light(example(), {1e4, 0, false}, false).front().method, IndirectMethod::paths)
      << "10^4 pixels do not pay for points";
}

/// A map costs its photons and look-ups and removes the caustics' noise; its own error remains. Without a map, caustics
/// that paths do not find remain missing.
TEST(WaysToLight, AMapOfCausticsPaysWhereTheyAreNoisyOrNotMet) {
  RoughFrame rough = example();
  rough.path = {10, 20, 2, 19, 1};
  rough.gather = {8, 19.5, 1.5, 19, 1};
  EXPECT_TRUE(ways_to_light(rough, kOrder, true).front().map);
  EXPECT_FALSE(ways_to_light(rough, kOrder, false).front().map) << "nothing can send them";
  rough.caustic = {{.square = 10 * 25}};  // 25 photons light a place
  EXPECT_FALSE(ways_to_light(rough, kOrder, true).front().map);
  rough = example();
  EXPECT_FALSE(ways_to_light(rough, kOrder, true).front().map);
  rough.path.missed_caustic.square = rough.gather.missed_caustic.square = 1;
  rough.path.missed_caustic.variance = rough.gather.missed_caustic.variance = 1e9;
  EXPECT_TRUE(ways_to_light(rough, kOrder, true).front().map);
}

/// A way that surely lacks light comes after all others, however low its score, and the reason says how much it lacks.
/// One frame of a segment suffices.
TEST(WaysToLight, ThatSurelyLackLightComeLast) {
  RoughFrame rough = example();
  rough.path = {10, 1, 1, 1, 1};
  ASSERT_FALSE(ways_to_light(rough, kOrder, true).front().map);
  EXPECT_EQ(because(ways_to_light(rough, kOrder, true)).find("lacks"), std::string::npos);
  rough.path.missed_caustic.never = rough.gather.missed_caustic.never = 0.049;
  const std::vector<Way> ways = ways_to_light(rough, kOrder, true);
  for (std::size_t i = 0; i < ways.size(); ++i) EXPECT_EQ(ways[i].map, i < 3);
  EXPECT_LT(ways[3].score(), ways[0].score());
  EXPECT_NE(because(ways).find("lacks 4.9 % of its light"), std::string::npos) << because(ways);
  EXPECT_TRUE(joined({ways_to_light(example(), kOrder, true), ways}).front().map);
}

/// Paths that know indirect light from lone samples alone come after ways that read points, however low their score.
TEST(WaysToLight, PathsThatSeldomMeetTheLightComeLast) {
  RoughFrame rough = example();
  const Order small{1e4, 0, false};
  ASSERT_EQ(ways_to_light(rough, small, true).front().method, IndirectMethod::paths);
  rough.path.missed_indirect.uncertain = 0.3;
  const std::vector<Way> ways = ways_to_light(rough, small, true);
  for (std::size_t i = 0; i < ways.size(); ++i) EXPECT_EQ(ways[i].method == IndirectMethod::paths, i >= 4);
  EXPECT_NE(because(ways).find("paths meet 30 % of the light too seldom"), std::string::npos) << because(ways);
  EXPECT_NE(joined({ways_to_light(example(), small, true), ways}).front().method, IndirectMethod::paths);
}

/// If only photons find a part of the light, paths miss it and records win, although the light that paths found does
/// not require records.
TEST(WaysToLight, RecordsFindWhatPathsMiss) {
  RoughFrame rough = example();
  rough.path = {10, 1, 1, 1, 1};
  rough.path.missed_indirect.square = 5;
  rough.path.missed_indirect.variance = 1e9;
  EXPECT_NE(ways_to_light(rough, kOrder, false).front().method, IndirectMethod::paths);
}

TEST(WaysToLight, WhereNothingIsMatteArePaths) {
  RoughFrame rough;
  const std::vector<Way> ways = ways_to_light(rough, kOrder, true);
  for (const Way& one : ways) EXPECT_EQ(one.method, IndirectMethod::paths);
}

/// For two frames the way with the least product of summed work and summed error is taken: in one frame paths are a
/// hundredth better, in the other ten times worse.
TEST(WaysToLight, JoinedByTheSums) {
  const Way paths{IndirectMethod::paths, false, 0, 1, 0.99}, records{IndirectMethod::records, false, 80, 1, 1},
      slow{IndirectMethod::paths, false, 0, 10, 1};
  Way more = records;
  more.rays = 120;
  const std::vector<Way> all = joined({{paths, records}, {more, slow}});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all.front().method, IndirectMethod::records);
  EXPECT_EQ(all.front().rays, 120);
  EXPECT_EQ(all.front().work, 2);
}

}  // namespace
}  // namespace tempolux
