// Updated points against points estimated anew: direct light equal to the bit, indirect light within its noise.
#include "lib/points/update_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/points/whole_photons.h"
#include "lib/photon/dynamic_map.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using formats::Photon;

/// A room of 4 x 3 x 4 m with a lamp under its ceiling and a moving box of .6 m, and the inputs of an update of its
/// points.
struct Room {
  test::HandMadeScene scene;
  SceneFrame frame, standing;
  EmissionTable table;
  std::vector<Photon> fixed, dynamic, global;
  PointOptions options;

  explicit Room(Vec3 at, bool lamp_moves = false, std::uint64_t photon_count = 60000) {
    scene.add_room({0, 0, 0}, {4, 3, 4}, test::matte({0.7f, 0.6f, 0.5f}));
    scene.add_quad({1.7f, 2.95f, 1.7f}, {2.3f, 2.95f, 1.7f}, {2.3f, 2.95f, 2.3f}, {1.7f, 2.95f, 2.3f},
                   test::matte(Rgb(0.0f), Rgb(10.0f)), lamp_moves);
    scene.add_box(at, at + Vec3{0.6f, 0.6f, 0.6f}, test::matte(Rgb(0.3f)), true);
    frame = scene.frame();
    standing = static_scene_of(frame);
    table = build_emission_table(std::span(&frame, 1));
    PhotonOptions photons;
    photons.photon_count = photon_count;
    photons.group_count = 1;
    const Tracer whole(frame), without(standing);
    const Lights lights(frame, table), static_lights(standing, table);
    const PhotonTracer a(whole, lights, photons), b(without, static_lights, photons);
    global = test::photons_of(a);
    fixed = test::photons_of(b);
    std::vector<std::uint64_t> paths(a.photon_count());
    for (std::uint64_t i = 0; i < paths.size(); ++i) paths[i] = i;
    dynamic = difference_of(b, a, paths).block.photons;
    options.count = 4000;
  }

  std::vector<IrradiancePoint> standing_points() const {
    std::vector<IrradiancePoint> points = place_points(standing, options).points;
    const Tracer tracer(standing);
    estimate_points(tracer, Lights(standing, table), fixed, {}, options, points);
    return points;
  }
  std::vector<IrradiancePoint> fresh_points() const {
    std::vector<IrradiancePoint> points = place_points(frame, options).points;
    const Tracer tracer(frame);
    estimate_points(tracer, Lights(frame, table), global, {}, options, points);
    return points;
  }
  PointUpdateCounts update(std::vector<IrradiancePoint>& points) const {
    const Tracer whole(frame), without(standing);
    const Lights lights(frame, table);
    return update_points({whole, without, lights, {fixed, dynamic, {}, {}}}, options, points);
  }
};

TEST(UpdatePoints, StaticPointsComeFirstAndStayWhereTheyAre) {
  const Room here({0.5f, 0, 0.5f}), there({3, 1, 3});
  const auto a = here.standing_points(), b = here.fresh_points(), c = there.fresh_points();
  ASSERT_LT(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].position, b[i].position);
    ASSERT_EQ(a[i].position, c[i].position);
    ASSERT_EQ(a[i].object, b[i].object);
  }
}

/// Seen to fail: random numbers by a point's place in the order of work.
TEST(UpdatePoints, DirectLightIsThatOfFreshPointsToTheBit) {
  const Room room({1.5f, 0, 1.5f});
  std::vector<IrradiancePoint> points = room.standing_points();
  const PointUpdateCounts counts = room.update(points);
  const auto fresh = room.fresh_points();
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(points[i].direct, fresh[i].direct) << i;
  EXPECT_GT(counts.direct, 0u);
  EXPECT_LT(counts.direct, points.size() / 4);  // the box does not hide the lamp from most points
}

TEST(UpdatePoints, IndirectLightIsThatOfFreshPointsWithinNoise) {
  const Room room({1.5f, 0, 1.5f});
  std::vector<IrradiancePoint> points = room.standing_points();
  const PointUpdateCounts counts = room.update(points);
  const auto fresh = room.fresh_points();
  // One estimate has a relative standard error of 1 / sqrt(50), and estimates from one photon map differ by less: 4
  // times sqrt(2) of this for each point. The mean over thousands of points has .3 %, 2 % of the scatter of points
  // estimated anew.
  double sum = 0, fresh_sum = 0;
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += double(points[i].indirect.g);
    fresh_sum += double(fresh[i].indirect.g);
    beyond += std::abs(points[i].indirect.g - fresh[i].indirect.g) >
              4 * std::sqrt(2 / 50.0f) * std::max(points[i].indirect.g, fresh[i].indirect.g);
  }
  EXPECT_EQ(beyond, 0u);
  EXPECT_NEAR(sum / fresh_sum, 1, 0.003);
  EXPECT_GT(counts.anew, 0u);
  EXPECT_LT(counts.anew, points.size() / 5);
}

TEST(UpdatePoints, WithoutDynamicPhotonsAndMoversNothingChanges) {
  Room room({10, 0, 10});  // outside the room
  ASSERT_TRUE(room.dynamic.empty());
  const std::vector<IrradiancePoint> before = room.standing_points();
  std::vector<IrradiancePoint> points = before;
  room.update(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(points[i].indirect, before[i].indirect);
    ASSERT_EQ(points[i].direct, before[i].direct);
    ASSERT_EQ(points[i].radius, before[i].radius);
  }
}

/// Where nothing is left of the static light, and where a box takes half of the lamp's light away: the sum of all
/// points' indirect light is that of fresh points. Cut parts would add up to 1.6 times as much in the second case. Seen
/// to fail: the change alone cut at 0.
TEST(UpdatePoints, TheSumIsCutAtZeroNotItsParts) {
  // Updated points all have one radius, and points estimated anew have their own. So updated points are more blurred,
  // but at the edges of walls the area of both is clipped in the same way.
  for (const bool lamp_moves : {true, false}) {
    const Room room(lamp_moves ? Vec3{1.5f, 0, 1.5f} : Vec3{1.4f, 2.33f, 1.7f}, lamp_moves);
    std::vector<IrradiancePoint> points = room.standing_points();
    double standing = 0, sum = 0, fresh_sum = 0;
    for (const IrradiancePoint& point : points) standing += double(point.indirect.g);
    room.update(points);
    const auto fresh = room.fresh_points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_GE(min_component(points[i].indirect), 0);
      ASSERT_EQ(points[i].direct, fresh[i].direct);
      sum += double(points[i].indirect.g), fresh_sum += double(fresh[i].indirect.g);
    }
    if (lamp_moves) {
      EXPECT_EQ(standing, 0);
    } else EXPECT_GT(standing / fresh_sum, 1.5);
    EXPECT_NEAR(sum / fresh_sum, 1, lamp_moves ? 0.02 : 0.05) << lamp_moves;
  }
}

/// Directions stay with their photons: of two static photons the dynamic map removes the first and adds a third.
TEST(WholePhotons, DirectionsStayWithTheirPhotons) {
  const auto photon = [](float x, float flux) {
    return Photon{{x, 0, 0}, {flux, flux, flux}, {}, 1, formats::PathKind::caustic, 1};
  };
  formats::PhotonBlock fixed, dynamic;
  fixed.photons = {photon(1, 1), photon(2, 1)};
  fixed.directions = {{1, 1}, {2, 2}};
  dynamic.photons = {photon(1, -1), photon(3, 1)};
  dynamic.directions = {{1, 1}, {3, 3}};
  const auto all = [](Vec3, const Photon&) { return true; };
  const formats::PhotonBlock whole = whole_photons({fixed, dynamic, {}, {}}, all);
  ASSERT_EQ(whole.photons.size(), 2u);
  ASSERT_EQ(whole.directions.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(float(whole.directions[i][0]), whole.photons[i].position[0]);
  EXPECT_TRUE(whole_photons({fixed.photons, dynamic, {}, {}}, all).directions.empty()) << "of some only";
}

}  // namespace
}  // namespace tempolux
