// Records of the world: what they hold follows from surfaces, not from cameras.
#include "lib/gather/world_records.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "lib/core/parallel.h"
#include "tests/support/gather_room.h"

namespace tempolux {
namespace {

using test::GatherRoom;
using test::HandMadeScene;
using test::matte;
using test::pixel_by_pixel;

/// A plane of 4 m has 16 x 16 cells of .25 m. Its border may cut the outermost, so at least 14 x 14 cells within 1.8 m
/// are whole. Each cell has one place. Seen to fail: with two lines in a column; with lines along other axes.
TEST(WorldPlaces, APlaneHasOnePlaceACell) {
  HandMadeScene scene;
  scene.add_quad({-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  const WantedPlace centre[] = {{{0, 0, 0}, {0, 1, 0}}};
  const std::vector<WorldPlace> places = world_places(tracer, -4, 4, centre);
  EXPECT_EQ(spacing_of(-4), 0.25f);
  const PlaceCells cells(tracer, -4);
  std::map<std::pair<int, int>, int> in_cell;
  for (const WorldPlace& place : places) {
    EXPECT_EQ(place.normal.y, 1);
    EXPECT_NEAR(place.surface.position.y, 0, 1e-6f);
    ++in_cell[{cells.at(place.surface.position, 0), cells.at(place.surface.position, 2)}];
  }
  int whole = 0;
  for (const auto& [cell, count] : in_cell) {
    EXPECT_EQ(count, 1);
    whole += std::abs(cells.local(cell.first + 0.5, 0)) < 1.8f && std::abs(cells.local(cell.second + 0.5, 2)) < 1.8f;
  }
  EXPECT_GE(whole, 14 * 14);
}

/// Places do not depend on what is wanted: around two wanted places, the places near both are equal to the bit.
TEST(WorldPlaces, FollowFromTheSurfacesAlone) {
  const GatherRoom room;
  const WantedPlace one[] = {{{0, -1, 0.5f}, {0, 1, 0}}}, other[] = {{{0.3f, -1, 0.6f}, {0, 1, 0}}};
  std::map<std::uint64_t, Vec3> known;
  for (const WorldPlace& place : world_places(*room.tracer, -8, 0.8f, one)) known[place.key] = place.surface.position;
  std::size_t shared = 0, near = 0;
  for (const WorldPlace& place : world_places(*room.tracer, -8, 0.8f, other)) {
    const Vec3 p = place.surface.position;
    if (std::abs(p.x) > 0.75f || std::abs(p.z - 0.5f) > 0.75f || std::abs(p.y + 1) > 0.75f) continue;
    ++near;
    const auto found = known.find(place.key);
    if (found != known.end()) shared += length2(found->second - p) == 0;
  }
  EXPECT_GT(near, 50u);
  EXPECT_EQ(shared, near);
}

RecordStore records_for(const GatherRoom& room, std::span<const Vec3> eyes) {
  WorldRecords world(*room.gather, *room.tracer, {});
  GatherCounts counts;
  int frame = 0;
  for (const Vec3 eye : eyes)
    world.want(
        wanted_points(pixel_by_pixel([&](float x, float y, const PathRandom*) { return room.see(x, y, 96, 64, eye); }),
                      frame++, 96, 64));
  world.choose(counts);
  RecordStore store;
  world.gather({}, store, counts);
  return store;
}

/// Two cameras that see the same surfaces read the same light, whatever else each of them sees. A place near the border
/// of a picture may have a record more (WorldRecords), so light at the inner pixels of the first picture is compared,
/// where the second camera looks as well. The cameras are close: where one is nearer by a level it has narrower
/// records, which the other reads at the border of that level. Seen to fail: with places keyed by pixels
/// (place_records) no two values agree.
TEST(WorldRecords, LightAtAPlaceDoesNotDependOnTheCamera) {
  const GatherRoom room;
  const Vec3 here{0.9f, 0.7f, 0.9f}, there{0.88f, 0.71f, 0.91f};
  const RecordStore first = records_for(room, std::array{here}), both = records_for(room, std::array{here, there});
  int same = 0, compared = 0, covered = 0;
  for (int y = 8; y < 56; ++y)
    for (int x = 8; x < 88; ++x) {
      const auto seen = room.see(float(x) + 0.5f, float(y) + 0.5f, 96, 64, here);
      const auto a = first.interpolate(seen->surface.position, seen->normal),
                 b = both.interpolate(seen->surface.position, seen->normal);
      ++compared;
      covered += a.weight > 0;
      // The order of records in the stores differs, so sums differ by rounding.
      same += std::abs(a.irradiance.g - b.irradiance.g) <= 1e-5f * b.irradiance.g;
    }
  EXPECT_GT(covered, compared * 98 / 100);
  EXPECT_GT(same, compared * 95 / 100);
}

TEST(WorldRecords, AreTheSameForAnyNumberOfThreads) {
  const GatherRoom room;
  const Vec3 eye[] = {{0.9f, 0.7f, 0.9f}};
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return records_for(room, eye);
  };
  const RecordStore one = with_threads(1), three = with_threads(3);
  ASSERT_EQ(one.records().size(), three.records().size());
  for (std::size_t i = 0; i < one.records().size(); ++i)
    EXPECT_EQ(one.records()[i].irradiance.g, three.records()[i].irradiance.g);
}

/// Two sets of records with independent random numbers: half of the squared difference of their interpolated light is
/// the variance of one, and so is the mean square of the interpolated noise. A frame's noise is to be right within 1.3,
/// so mean squares may differ by 1.3^2. Chance adds little: the ratio of 12 records that are gathered twice errs by
/// sqrt(3/12) = 50 %, over 40 sets by 8 %. The ratio is 1.21; if no record is
/// gathered twice it is 1.69, at the limit.
TEST(WorldRecords, TheirNoiseIsThatBetweenSeeds) {
  const GatherRoom room;
  double said = 0, measured = 0;
  const PixelView views = pixel_by_pixel([&](float x, float y, const PathRandom*) { return room.see(x, y, 128, 96); });
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::array<RecordStore, 2> stores;
    for (std::uint64_t i = 0; i < 2; ++i) {
      const FinalGather gather = room.gather->with_seed(2 * seed + i);
      WorldRecords world(gather, *room.tracer, {});
      world.want(wanted_points(views, 0, 128, 96));
      GatherCounts counts;
      world.choose(counts);
      world.gather({}, stores[i], counts);
    }
    for (int y = 2; y < 96; y += 4)
      for (int x = 2; x < 128; x += 4) {
        const auto seen = room.see(float(x), float(y), 128, 96);
        const auto a = stores[0].interpolate(seen->surface.position, seen->normal),
                   b = stores[1].interpolate(seen->surface.position, seen->normal);
        const double difference = double(a.irradiance.g) - double(b.irradiance.g);
        measured += difference * difference / 2;
        said += double(a.noise.g * a.noise.g + b.noise.g * b.noise.g) / 2;
      }
  }
  EXPECT_LT(said / measured, 1.3 * 1.3);
  EXPECT_GT(said / measured, 1 / (1.3 * 1.3));
}

/// A panel stands 2 mm in front of a wall. The wall behind it gets no records, since it sees the panel closer than a
/// pixel; with records the wall would be dark up to four pixels beside the panel. Seen to fail: without this
/// rule.
TEST(WorldRecords, CracksHaveNone) {
  HandMadeScene scene;
  scene.add_quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, matte(Rgb(0.5f)));
  scene.add_quad({-2, -2, 0.002f}, {0, -2, 0.002f}, {0, 2, 0.002f}, {-2, 2, 0.002f}, matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), EmissionTable{});
  const std::vector<IrradiancePoint> points;
  const PointLookup lookup(points, 1.0f);
  const FinalGather gather(tracer, lights, lookup, {});
  WorldRecords world(gather, tracer, {});
  GatherCounts counts;
  const auto view = pixel_by_pixel([&](float x, float y, const PathRandom*) -> std::optional<SeenPoint> {
    Hit hit;
    if (!tracer.intersect({{(x - 32) / 32, (y - 32) / 32, 2}, {0, 0, -1}}, hit)) return std::nullopt;
    return SeenPoint{tracer.surface_point(hit), {0, 0, 1}, 1.0f / 32, false};
  });
  world.want(wanted_points(view, 0, 64, 64));
  world.choose(counts);
  RecordStore store;
  world.gather({}, store, counts);
  EXPECT_GT(store.records().size(), 20u);
  for (const IrradianceRecord& record : store.records())
    EXPECT_TRUE(record.position.x > 0 || record.position.z > 0.001f) << record.position.x;
}

}  // namespace
}  // namespace tempolux
