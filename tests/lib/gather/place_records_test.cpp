// Placement of records: every pixel covered, the same for any number of threads; limits of the radius.
#include "lib/gather/place_records.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lib/core/parallel.h"
#include "tests/support/gather_room.h"
#include "tests/support/pixel_views.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using Room = test::GatherRoom;
using test::HandMadeScene;
using test::matte;
using test::pixel_by_pixel;

TEST(PlaceRecords, EveryPixelIsCoveredAndASecondTimeNothingIsAdded) {
  const Room room;
  RecordStore store;
  GatherCounts counts;
  const std::size_t added = room.place(96, 64, store, counts);
  EXPECT_EQ(added, store.records().size());
  EXPECT_GT(added, 20u);
  EXPECT_LT(added, 96u * 64u / 4);
  int covered = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const auto seen = room.see(float(x) + 0.5f, float(y) + 0.5f, 96, 64);
      ASSERT_TRUE(seen);
      covered += store.interpolate(seen->surface.position, seen->normal).weight >= PlacementOptions{}.min_weight;
    }
  EXPECT_EQ(covered, 96 * 64);
  EXPECT_EQ(room.place(96, 64, store, counts), 0u);
}

/// A small bright patch of radiance 1: directly below one of 300 gather rays meets it, farther away one of 3000. If the
/// rays that estimate light also decided on the radius, records that miss the patch would reach farthest, and the floor
/// would be half dark. The mean irradiance of the floor against 4 a^2 h^2 / (h^2 + d^2)^2 (exact to a^2 = 0.3 %):
/// interpolation has a bias of -2.5 %. One or two of a record's 500 rays meet the patch, an error of 80 %; the dozen
/// records of each of 400 runs have 1.2 % together.
TEST(PlaceRecords, SmallBrightThingsAreNotOutweighedByRecordsThatMissThem) {
  constexpr float a = 0.05f, kHalf = 1.5f;
  constexpr int kSize = 48, kRuns = 400;
  HandMadeScene scene;
  scene.add_quad({-a, 1, -a}, {a, 1, -a}, {a, 1, a}, {-a, 1, a}, matte(Rgb(1.0f)));
  IrradiancePoint bright;
  bright.position = {0, 1, 0};
  bright.normal = {0, -1, 0};
  bright.indirect = Rgb(kPi);
  const std::vector<IrradiancePoint> points{bright};
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), EmissionTable{});
  const PointLookup lookup(points, 1);
  const auto floor = [](float x, float y, const PathRandom*) {
    SeenPoint seen;
    seen.surface.position = {kHalf * (2 * x / kSize - 1), 0, kHalf * (2 * y / kSize - 1)};
    seen.normal = seen.surface.normal = seen.surface.normal_geometric = {0, 1, 0};
    seen.surface.offset = 1e-6f;
    seen.footprint = 2 * kHalf / kSize / 4;
    return std::optional(seen);
  };
  double found = 0, exact = 0;
  for (int run = 0; run < kRuns; ++run) {
    const GatherOptions options{.seed = std::uint64_t(run), .rays = 500};
    const FinalGather gather(tracer, lights, lookup, options);
    RecordStore store;
    GatherCounts counts;
    place_records(gather, {pixel_by_pixel(floor), kSize, kSize}, {}, store, counts);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Vec3 at = floor(float(x) + 0.5f, float(y) + 0.5f, nullptr)->surface.position;
        found += double(store.interpolate(at, {0, 1, 0}).irradiance.g);
        const double d2 = double(length2(at));
        exact += 4 * double(a * a) / ((1 + d2) * (1 + d2));
      }
  }
  EXPECT_NEAR(found / exact, 1, 0.045);
}

TEST(PlaceRecords, TheSameRecordsForAnyNumberOfThreads) {
  const Room room;
  std::vector<IrradianceRecord> first;
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    RecordStore store;
    GatherCounts counts;
    room.place(64, 48, store, counts);
    if (first.empty()) first.assign(store.records().begin(), store.records().end());
    ASSERT_EQ(store.records().size(), first.size()) << threads;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const IrradianceRecord &a = first[i], &b = store.records()[i];
      ASSERT_TRUE(a.position == b.position && a.normal == b.normal && a.irradiance == b.irradiance &&
                  a.radius == b.radius && a.rotational == b.rotational && a.translational == b.translational)
          << "record " << i << ", " << threads << " threads";
    }
  }
}

/// A pixel that is larger than the room still gets its record. A picture that shows nothing gets none.
TEST(PlaceRecords, PicturesOfOnePixelAndOfNothing) {
  const Room room;
  RecordStore store;
  GatherCounts counts;
  EXPECT_GE(room.place(1, 1, store, counts), 1u);
  RecordStore none;
  const PixelView nothing = pixel_by_pixel([](float, float, const PathRandom*) { return std::optional<SeenPoint>(); });
  EXPECT_EQ(place_records(*room.gather, {nothing, 32, 32}, {}, none, counts), 0u);
}

/// Pixels that see by a choice (glass) are also tested at positions within the pixel, with random numbers for the
/// choice.
TEST(PlaceRecords, PixelsBehindGlassAreSampledWithin) {
  const Room room;
  RecordStore store;
  GatherCounts counts;
  int drawn = 0;
  const PixelView view = pixel_by_pixel([&](float x, float y, const PathRandom* random) {
    drawn += random != nullptr;
    auto seen = room.see(x, y, 8, 8);
    if (seen) seen->by_choice = true;
    return seen;
  });
  const ThreadLimit limit(1);
  place_records(*room.gather, {view, 8, 8}, {}, store, counts);
  EXPECT_EQ(drawn, 4 * 64);
}

/// The first 256 points of the coarsest lattice (625 points) are gathered in parallel, before any record exists. Each
/// of their records covers all of this small patch, so later batches gather nothing.
TEST(PlaceRecords, RecordsOfOneBatchServeTheNext) {
  const Room room;
  RecordStore store;
  GatherCounts counts;
  const PixelView patch = pixel_by_pixel([](float x, float y, const PathRandom*) {
    SeenPoint seen;
    seen.surface.position = {1e-5f * x, 0, 1e-5f * y};
    seen.normal = seen.surface.normal = seen.surface.normal_geometric = {0, 1, 0};
    seen.footprint = 1;
    return std::optional(seen);
  });
  EXPECT_EQ(place_records(*room.gather, {patch, 400, 400}, {}, store, counts), 256u);
}

/// A step between two parallel planes of one object is an edge, whose pixels are tested within. A plane seen at a
/// grazing angle is no edge, although the distance changes from pixel to pixel by more than the step.
TEST(PlaceRecords, StepsBetweenParallelPlanesAreEdges) {
  const Room room;
  constexpr int kSize = 12;
  const auto looked_within = [&](float step, Vec3 across) {
    RecordStore store;
    GatherCounts counts;
    int within = 0;
    const PixelView view = pixel_by_pixel([&](float x, float y, const PathRandom* random) {
      within += random != nullptr;
      SeenPoint seen;
      seen.surface.position =
          across * (0.01f * (x - kSize / 2)) + Vec3{0, 0, 1} * (0.01f * y) + Vec3{0, x < kSize / 2 ? step : 0, 0};
      seen.normal = seen.surface.normal = seen.surface.normal_geometric = {0, 1, 0};
      seen.footprint = 0.01f;
      return std::optional(seen);
    });
    const ThreadLimit limit(1);
    place_records(*room.gather, {view, kSize, kSize}, {}, store, counts);
    return within;
  };
  EXPECT_EQ(looked_within(0.05f, {1, 0, 0}), 4 * 2 * kSize);  // the columns next to the step
  // a step of one footprint: the surface is rough or seen at a grazing angle
  EXPECT_EQ(looked_within(0.01f, {1, 0, 0}), 0);
  EXPECT_EQ(looked_within(0, {8, 0, 0}), 0);
}

IrradianceRecord gathered(float irradiance, Vec3 slope, float harmonic) {
  IrradianceRecord r;
  r.normal = {0, 1, 0};
  r.irradiance = Rgb(irradiance);
  r.translational = {slope, slope, slope};
  r.radius_unclamped = harmonic;
  return r;
}

TEST(RadiusOf, EachLimitDecidesWhereItIsTheSmallest) {
  const PlacementOptions options{.error_bound = 0.2f, .min_radius_px = 4, .unseen_radius_px = 500};
  EXPECT_FLOAT_EQ(radius_of(gathered(1, {}, 1), 1e-3f, options), 0.2f);         // error_bound x harmonic mean
  EXPECT_FLOAT_EQ(radius_of(gathered(1, {}, INFINITY), 1e-3f, options), 0.5f);  // all rays miss
  EXPECT_FLOAT_EQ(radius_of(gathered(1, {}, 1e-5f), 1e-3f, options), 4e-3f);    // the least radius: 4 pixels
  IrradianceRecord near =
      gathered(1, {1, 0, 0}, 5e-3f);  // error_bound x R = 1 mm, widened fourfold: the gradient is divided by 4
  limit_radius(near, 1e-3f, options);
  EXPECT_FLOAT_EQ(near.translational[0].x, 0.25f);
  EXPECT_FLOAT_EQ(near.radius_unclamped, 1e-3f);
  IrradianceRecord steep =
      gathered(1, {10, 0, 0}, 1);  // 3 channels of 1 W/m^2, 10 W/m^3 over 0.2 m: twice the irradiance
  limit_radius(steep, 1e-3f, options);
  EXPECT_FLOAT_EQ(steep.translational[0].x, 5);
}

/// Light times a power of two gives the same radii and gradients times that power, even if squares exceed the range of
/// floats.
TEST(LimitRadius, DoesNotDependOnTheStrengthOfTheLight) {
  const PlacementOptions options{.unseen_radius_px = 500};
  for (float slope : {1.0f, 4.0f, 100.0f})
    for (float harmonic : {1e-3f, 0.05f, 1.0f}) {
      IrradianceRecord one = gathered(1, {slope, 0, -slope}, harmonic);
      limit_radius(one, 1e-3f, options);
      for (float power : {0x1p-66f, 0x1p66f, 0x1p99f}) {
        IrradianceRecord scaled = gathered(power, {slope * power, 0, -slope * power}, harmonic);
        limit_radius(scaled, 1e-3f, options);
        EXPECT_EQ(scaled.radius, one.radius) << power;
        EXPECT_EQ(scaled.translational[0].x, one.translational[0].x * power) << power;
      }
    }
}

/// Formulas of the literature divide 0 by 0 in these cases; here the result is the largest or smallest radius.
TEST(LimitRadius, DegenerateGathers) {
  const PlacementOptions options{.unseen_radius_px = 500};
  IrradianceRecord misses = gathered(0, {}, INFINITY);
  limit_radius(misses, 1e-3f, options);
  EXPECT_EQ(misses.radius, 0.5f);
  IrradianceRecord touching = gathered(1, {1e20f, 0, 0}, 0);
  limit_radius(touching, 1e-3f, options);
  EXPECT_FLOAT_EQ(touching.radius, options.min_radius_px * 1e-3f);
  EXPECT_EQ(touching.translational[0].x, 0);
  IrradianceRecord dark = gathered(0, {}, 1);
  limit_radius(dark, 1e-3f, options);
  EXPECT_FLOAT_EQ(dark.radius, options.error_bound);
  for (const IrradianceRecord& r : {misses, touching, dark}) {
    EXPECT_TRUE(std::isfinite(r.radius));
    for (Vec3 g : r.translational) EXPECT_TRUE(is_finite(g));
  }
}

}  // namespace
}  // namespace tempolux
