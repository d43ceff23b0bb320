// Clearance: the polygon of what was seen around a place.
#include "lib/irradcache/clearance.h"

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/irradcache/records.h"

namespace tempolux {
namespace {

const Vec3 kNormal = normalize(Vec3{0.2f, 0.9f, -0.4f});

/// Clearance with reach 1 around a place. `inside` is false behind walls. Spokes are rounded down as in Clearance.
template <class Inside>
Clearance look(const Inside& inside) {
  const Frame frame(kNormal);
  Clearance seen;
  seen.reach = 1;
  for (std::uint32_t k = 0; k < Clearance::kSpokes; ++k) {
    const Vec2 u = Clearance::spoke(k);
    float gone = 0;
    while (gone < 1 && inside(u.x * gone, u.y * gone)) gone += 1e-4f;
    seen.set(k, std::min(gone, 1.0f));
  }
  return seen;
}

/// Straight walls at any distance and angle: no place behind a wall is inside. More than .93 of the places in front
/// of it are inside: rounding of the spokes takes up to 1/255 of the reach, and the straight ends between spokes take
/// 3 % to 5 % of the area at the reach.
TEST(Clearance, EndsAtStraightWalls) {
  const Frame frame(kNormal);
  const PathRandom random(1, 1);
  int in_front = 0, known = 0;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const float phi = 2 * kPi * random.get1(3 * i, Purpose::test),
                far = 0.1f + 0.8f * random.get1(3 * i + 1, Purpose::test);
    const auto is_in_front = [&](float x, float y) { return x * std::cos(phi) + y * std::sin(phi) < far; };
    const Clearance seen = look(is_in_front);
    for (std::uint32_t j = 0; j < 300; ++j) {
      const Vec2 d = sample_disc_concentric(random.get2(j, Purpose::place));
      const bool inside = seen.contains(frame.tangent * d.x + frame.bitangent * d.y + kNormal * 0.01f, kNormal);
      EXPECT_FALSE(inside && !is_in_front(d.x, d.y)) << d.x << " " << d.y;
      in_front += is_in_front(d.x, d.y);
      known += inside;
    }
  }
  EXPECT_GT(known, 0.93 * in_front);
}

TEST(Clearance, AllAroundIsADiscAndNothingIsThePlaceItself) {
  const Frame frame(kNormal);
  Clearance open = look([](float, float) { return true; });
  EXPECT_EQ(open.shares, Clearance::kOpen);
  EXPECT_TRUE(open.contains(frame.tangent * 0.999f, kNormal));
  EXPECT_FALSE(open.contains(frame.tangent * 1.001f, kNormal));
  Clearance walled = look([](float, float) { return false; });
  EXPECT_EQ(walled.shares, (Clearance::Shares{0, 0}));
  EXPECT_TRUE(walled.contains({0, 0, 0}, kNormal));
  EXPECT_FALSE(walled.contains(frame.bitangent * 1e-4f, kNormal));
}

/// A record 1 cm in front of a wall is valid on its own side only, however large its radius.
TEST(Clearance, NoRecordCountsBehindAWall) {
  IrradianceRecord record;
  record.normal = kNormal;
  record.irradiance = Rgb(1.0f);
  record.radius = 1 / Clearance::kPerRadius;
  record.clearance = look([](float x, float) { return x < 0.2f; });
  const Frame frame(kNormal);
  RecordStore store;
  store.add(record);
  EXPECT_GT(store.interpolate(frame.tangent * 0.15f, kNormal).weight, 0);
  EXPECT_GT(store.interpolate(frame.tangent * -0.9f, kNormal).weight, 0);
  EXPECT_EQ(store.interpolate(frame.tangent * 0.21f, kNormal).weight, 0);
  EXPECT_FALSE(store.covers(frame.tangent * 0.21f, kNormal, 0.1f));
}

}  // namespace
}  // namespace tempolux
