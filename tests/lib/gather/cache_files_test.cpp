// Points and records keep their values in files.
#include "lib/gather/cache_files.h"

#include <gtest/gtest.h>

namespace tempolux {
namespace {

/// A record in which every value is different; all are exact in a file.
IrradianceRecord record() {
  IrradianceRecord r;
  r.position = {1, 2, 3};
  r.normal = {0, 1, 0};
  r.irradiance = {4, 5, 6};
  r.rotational = {Vec3{7, 8, 9}, Vec3{10, 11, 12}, Vec3{13, 14, 15}};
  r.translational = {Vec3{16, 17, 18}, Vec3{19, 20, 21}, Vec3{22, 23, 24}};
  r.radius = 25;
  r.radius_unclamped = 26;
  r.clearance.reach = 27;
  for (std::uint32_t k = 0; k < Clearance::kSpokes; ++k) r.clearance.set(k, 27 * float(k + 1) / 17);
  r.object = 28;
  return r;
}

TEST(CacheFiles, ARecordKeepsItsValues) {
  const IrradianceRecord r = record();
  formats::IrradianceCacheRecord stored;
  store_values(r, stored);
  const IrradianceRecord back = stored_values(stored);
  EXPECT_EQ(back.position, r.position);
  EXPECT_EQ(back.normal, r.normal);
  EXPECT_EQ(back.irradiance, r.irradiance);
  EXPECT_EQ(back.rotational, r.rotational);
  EXPECT_EQ(back.translational, r.translational);
  EXPECT_EQ(back.radius, r.radius);
  EXPECT_EQ(back.radius_unclamped, r.radius_unclamped);
  EXPECT_EQ(back.clearance, r.clearance);
  EXPECT_EQ(back.object, r.object);
}

// formats/irradcache/irradcache.md: byte k of the clearance is spoke k, in 1/255 of the reach, rounded down.
TEST(CacheFiles, ClearanceIsOneBytePerSpoke) {
  formats::IrradianceCacheRecord stored;
  store_values(record(), stored);
  EXPECT_EQ(stored.clearance_reach, 27);
  for (std::size_t k = 0; k < Clearance::kSpokes; ++k)
    EXPECT_NEAR(stored.clearance[k], 255 * double(k + 1) / 17, 1) << "spoke " << k;
}

TEST(CacheFiles, AClearanceThatWasNotMeasuredIsOpen) {
  formats::IrradianceCacheRecord stored;
  store_values(record(), stored);
  stored.clearance_reach = 0;
  EXPECT_EQ(stored_values(stored).clearance, Clearance{});
}

TEST(CacheFiles, RecordsAndPointsOfAFileAreShiftedIntoTheFramesSpace) {
  std::vector<formats::IrradianceCacheRecord> records(1);
  store_values(record(), records[0]);
  records[0].noise = {0.5f, 0.25f, 0.125f};
  const IrradianceRecord back = from_file(records, Vec3d{100, -10, 0.5})[0];
  EXPECT_EQ(back.position, (Vec3{101, -8, 3.5f}));
  EXPECT_EQ(back.noise, (Rgb{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(back.normal, record().normal);

  formats::IrradiancePointRecord point;
  point.position = {1, 2, 3};
  point.normal = formats::encode_normal({0, 1, 0});
  point.object = 7;
  point.radius = 0.5f;
  point.direct = {1, 2, 3};
  point.caustic = {4, 5, 6};
  point.indirect = {7, 8, 9};
  point.noise = {-1, 1, -1};
  const IrradiancePoint p =
      from_file(std::span<const formats::IrradiancePointRecord>(&point, 1), Vec3d{100, -10, 0.5})[0];
  EXPECT_EQ(p.position, (Vec3{101, -8, 3.5f}));
  EXPECT_NEAR(p.normal.y, 1, 1e-4);
  EXPECT_EQ(p.object, 7u);
  EXPECT_EQ(p.radius, 0.5f);
  EXPECT_EQ(p.total(), (Rgb{12, 15, 18}));
  EXPECT_EQ(p.noise, (Rgb{-1, 1, -1}));
}

}  // namespace
}  // namespace tempolux
