// Shares of the photons by what they bring into view, with answers known on paper.
#include "lib/pilot/photon_shares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

/// Two closed rooms of 2 m, 10 m apart, a lamp in each. Places on the walls of the first one are seen.
struct Rooms {
  HandMadeScene scene;
  std::vector<WeighedPlace> places;
  std::vector<formats::ViewSphere> cells{{{0, 0, 0}, 1.75, 1}};

  Rooms(float seen_lamp, float other_lamp, Vec3 other_place = {10, 0, 0}) {
    scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
    scene.add_room({9, -1, -1}, {11, 1, 1}, matte(Rgb(0.5f)));
    scene.add_point_light({0.1f, 0.2f, 0}, Rgb(seen_lamp));
    scene.add_point_light(other_place, Rgb(other_lamp));
    for (int i = 0; i < 64; ++i) places.push_back({{-0.9 + 0.2 * (i % 8), -1, -0.9 + 0.2 * (i / 8)}, 1, 1, {0, 1, 0}});
  }
  EmissionTable table() { return build_emission_table({&scene.frame(), 1}); }
  std::vector<formats::ViewLight> shares() {
    const Tracer tracer(scene.frame());
    SharePilot pilot(cells, places, "caustic,indirect");
    pilot.look(tracer, table());
    return pilot.shares();
  }
};

/// The other room's light never arrives, however strong it is. Meant to catch: shares by flux.
TEST(PhotonShares, TheLampOfTheSeenRoomGetsThem) {
  Rooms rooms(1, 1e4f);
  const std::vector<formats::ViewLight> shares = rooms.shares();
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares[0].node, 0u);
  EmissionTable table = rooms.table();
  give_shares(rooms.scene.frame(), shares, table);
  EXPECT_NEAR(table.probability[0], 0.25 / 10001 + 0.75, 1e-9);
  EXPECT_NEAR(table.probability[1], 0.25 * 10000 / 10001, 1e-9);
}

/// Two lamps of one room, at places that mirror each other, bring light in proportion to their intensity, and so does
/// the root of the mean square: shares by flux are best already, and nothing changes.
TEST(PhotonShares, NothingChangesWhereSharesByFluxAreRight) {
  Rooms rooms(1, 4, {-0.1f, -0.2f, 0});
  EXPECT_TRUE(rooms.shares().empty());
}

/// The outer side of the seen room's wall is in the cell, too, and lit by a strong lamp outside. No seen place looks at
/// it. Meant to catch: all photons in the cell counted, which gave the lamp outside nearly all photons.
TEST(PhotonShares, TheOuterSideOfAWallDoesNotCount) {
  Rooms rooms(1, 1e4f, {0, 3, 0});
  rooms.scene.add_box({-1.2f, -1.2f, -1.2f}, {1.2f, 1.2f, 1.2f}, matte(Rgb(0.5f)));
  rooms.scene.add_quad({-9, -1.3f, 9}, {9, -1.3f, 9}, {9, -1.3f, -9}, {-9, -1.3f, -9}, matte(Rgb(0.8f)));
  const std::vector<formats::ViewLight> shares = rooms.shares();
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares[0].node, 0u);
}

/// Shares of lights that do not shine in this segment go to the others; without any the table stays.
TEST(PhotonShares, LightsThatAreOffGetNone) {
  Rooms rooms(1, 1);
  EmissionTable table = rooms.table();
  const std::vector<double> before = table.probability;
  give_shares(rooms.scene.frame(), std::vector<formats::ViewLight>{{99, 1}}, table);
  EXPECT_EQ(table.probability, before);
  give_shares(rooms.scene.frame(), std::vector<formats::ViewLight>{{99, 1}, {1, 0.5}}, table);
  EXPECT_NEAR(table.probability[1], 0.25 * 0.5 + 0.75, 1e-12);
  EXPECT_NEAR(std::accumulate(table.probability.begin(), table.probability.end(), 0.0), 1, 1e-12);
}

}  // namespace
}  // namespace tempolux
