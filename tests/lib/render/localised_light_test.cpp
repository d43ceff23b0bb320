// Localised light: updated records where light changes little, gathered ones where it changes much and on movers, both
// in between.
#include "lib/render/localised_light.h"

#include <gtest/gtest.h>

#include "lib/render/known_light.h"

namespace tempolux {
namespace {

constexpr Vec3 kUp{0, 1, 0};
constexpr std::uint32_t kMover = 3;

IrradianceRecord record(Vec3 position, float irradiance) {
  IrradianceRecord r;
  r.position = position;
  r.normal = kUp;
  r.irradiance = Rgb(irradiance);
  r.radius = r.radius_unclamped = 1;
  return r;
}

SurfacePoint place(Vec3 position, std::uint32_t object = 0) {
  SurfacePoint point;
  point.position = position;
  point.normal = point.normal_geometric = kUp;
  point.object = object;
  return point;
}

/// Three records 10 m apart with static irradiance 10 and E_t = 8, of relative influence 0, .105 and 1; gathered
/// records with E_y = 4 next to the last two.
struct Records {
  std::vector<IrradianceRecord> standing{record({0, 0, 0}, 10), record({10, 0, 0}, 10), record({20, 0, 0}, 10)};
  std::vector<RecordChange> changes{{Rgb(8.0f), 0}, {Rgb(8.0f), 1.05f}, {Rgb(8.0f), 10}};
  std::vector<IrradianceRecord> gathered{record({10, 0, 0}, 4), record({20, 0, 0}, 4)};
  LocalisedLight light() const {
    return {standing, changes, gathered, 0.9f, {}, MovingObjects({false, false, false, true})};
  }
};

float at(const LocalisedLight& light, const SurfacePoint& point) {
  const auto e = light.at(point, kUp);
  return e ? e->g : -1;
}

TEST(LocalisedLight, InfluenceDecidesWhichRecordsAreRead) {
  const LocalisedLight light = Records().light();
  EXPECT_EQ(at(light, place({0, 0, 0})), 8);
  EXPECT_EQ(at(light, place({20, 0, 0})), 4);
  // .105 lies halfway between .06 and .15: f = 1/2.
  EXPECT_NEAR(at(light, place({10, 0, 0})), 6, 1e-4f);
  EXPECT_NEAR(light.gathered_share(place({10, 0, 0}), kUp), 0.5f, 1e-5f);
}

TEST(LocalisedLight, OnWhatMovesOnlyGatheredRecordsCount) {
  const LocalisedLight light = Records().light();
  EXPECT_EQ(at(light, place({10, 0, 0}, kMover)), 4);
  // No record was gathered there: a gather ray must estimate the light.
  EXPECT_EQ(at(light, place({0, 0, 0}, kMover)), -1);
}

TEST(LocalisedLight, WhatIsMissingIsNotMadeUp) {
  const LocalisedLight light = Records().light();
  EXPECT_EQ(at(light, place({5, 0, 0})), -1);
  Records few;
  few.gathered.clear();
  EXPECT_EQ(at(few.light(), place({10, 0, 0})), -1);  // half of E_t alone would be too dark
  EXPECT_EQ(at(few.light(), place({0, 0, 0})), 8);
}

TEST(LocalisedLight, BelowZeroIsCutWhereItIsShown) {
  Records dark;
  dark.changes[0].updated_irradiance = {-1, 2, 0};
  const auto e = dark.light().at(place({0, 0, 0}), kUp);
  ASSERT_TRUE(e);
  EXPECT_EQ(e->r, 0);
  EXPECT_EQ(e->g, 2);
}

TEST(LocalisedLight, EqualRecordsBlendToThemselves) {
  Records same;
  for (RecordChange& change : same.changes) change.updated_irradiance = Rgb(4.0f);
  const LocalisedLight light = same.light();
  for (float x : {0.0f, 10.0f, 20.0f}) EXPECT_NEAR(at(light, place({x, 0, 0})), 4, 1e-6f);
}

TEST(LocalisedLight, ItTakesThePlaceOfRecords) {
  const LocalisedLight light = Records().light();
  KnownLight known;
  known.localised = &light;
  const SurfacePoint point = place({0, 0, 0});
  ASSERT_TRUE(known.indirect(point, kUp, kUp));
  EXPECT_EQ(known.indirect(point, kUp, kUp)->g, 8);
}

TEST(LocalisedLight, NoiseIsBlendedAsLightIs) {
  Records noisy;
  for (IrradianceRecord& standing : noisy.standing) standing.noise = {3, -1, 0};
  for (IrradianceRecord& gathered : noisy.gathered) gathered.noise = {-1, 5, 2};
  const LocalisedLight light = noisy.light();
  KnownLight known;
  known.localised = &light;
  const auto noise = [&](const SurfacePoint& point) {
    Rgb found{7.0f};
    EXPECT_TRUE(known.indirect(point, kUp, kUp, &found));
    return found;
  };
  const auto expect = [](Rgb a, Rgb b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-4f);
  };
  expect(noise(place({0, 0, 0})), {3, -1, 0});
  expect(noise(place({10, 0, 0})), {1, 2, 1});  // f = 1/2
  expect(noise(place({20, 0, 0})), {-1, 5, 2});
  expect(noise(place({10, 0, 0}, kMover)), {-1, 5, 2});
}

}  // namespace
}  // namespace tempolux
