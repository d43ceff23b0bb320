// Samples, light paths and gather rays of made-up pictures.
#include "lib/pilot/spread_work.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/pilot/places_seen.h"
#include "lib/render/pixel_noise.h"

namespace tempolux {
namespace {

constexpr double kPixels = 57600, kPartPixels = kPixels / kPilotParts;

/// One part of the picture has caustic light of 5 times the allowed error, and a light path leaves this many photons
/// there. Light paths leave no other photon.
RoughFrame lit(double photons_a_path) {
  RoughFrame rough;
  rough.caustic = {{.square = 25, .seen_square = 25, .photons = photons_a_path}};
  rough.photons_per_path = photons_a_path;
  return rough;
}

/// 64 samples of 20 shadow rays.
AskedPicture asked(double sample_error) {
  return {.pixels = kPixels,
          .sample_work = 20,
          .samples = 64,
          .sample_error = sample_error,
          .photons = 700'000,
          .most_photons = 11'200'000,
          .pictures = 24,
          .work = 1e8};
}

/// 400 pixels hold 400 d photons. Single pixels err by 2.4 x 25 / (25 + 16 d), boxes of 5 and 15 pixels by 2.4 x 25 /
/// (25 + 40 d) and 2.4 x 25 / (25 + 240 d). Without photons in sight all three err by 2.4.
TEST(SeenMapError, FallsWithThePhotonsOfABox) {
  const double d = 2, paths = 1e6;
  EXPECT_NEAR(seen_map_error(lit(d * kPartPixels / paths), kPixels, 1'000'000),
              2.4 * (25.0 / 57 + 25.0 / 105 + 25.0 / 505), 1e-12);
  EXPECT_NEAR(seen_map_error(lit(0), kPixels, 1'000'000), 2.4 * 3, 1e-12);
  EXPECT_EQ(seen_map_error(RoughFrame{}, kPixels, 1'000'000), 0);
}

/// Photons are cheap and caustic light has most of the error: more photons, and no more error than before. No
/// neighbouring numbers have a smaller product of the picture's work and error. Both are those of the header, written
/// once more. Meant to catch: the least work at an equal error, which leaves the error of caustic light as it is.
TEST(SpreadWork, TakesTheLeastProductOfWorkAndError) {
  const RoughFrame rough = lit(0.01 * kPartPixels / 700'000);
  AskedPicture picture = asked(2);
  const SpreadWork spread = spread_work(rough, picture);
  EXPECT_GT(spread.photons, picture.photons);
  EXPECT_EQ(spread.rays, 0);
  const double of_samples = 1.24 * 2 * std::pow(64, 1 - stratified_rate());
  const auto error = [&](double share, std::uint64_t photons) {
    return of_samples * std::pow(share, -0.75) + seen_map_error(rough, kPixels, photons);
  };
  const auto product = [&](double share, std::uint64_t photons) {
    const double further = double(photons) - 700'000, a_path = 0.6 * (1 + rough.photons_per_path);
    const double work = kPixels * 20 * 64 * (share - 1) + further * (a_path / 24 + 2 * rough.photons_per_path);
    return (picture.work + work) * error(share, photons);
  };
  const double best = product(spread.samples, spread.photons);
  EXPECT_LE(error(spread.samples, spread.photons), error(1, picture.photons));
  for (const std::uint64_t photons : {spread.photons / 2, spread.photons, 2 * spread.photons})
    for (const double times : {std::exp2(-0.25), 1.0, std::exp2(0.25)}) {
      const double share = spread.samples * times;
      if (photons < 700'000 || photons > 11'200'000 || share > 1 || share < 0.124) continue;
      if (error(share, photons) > error(1, 700'000)) continue;
      EXPECT_GE(product(share, photons), best * (1 - 1e-9)) << times << " " << photons;
    }
}

/// Nothing to trade: without caustic light, or if the map may not grow, all numbers stay.
TEST(SpreadWork, KeepsTheNumbersWhereNothingIsGained) {
  RoughFrame none;
  none.photons_per_path = 1;
  EXPECT_EQ(spread_work(none, asked(2)).samples, 1);
  EXPECT_EQ(spread_work(none, asked(2)).photons, 700'000u);
  AskedPicture fixed = asked(2);
  fixed.most_photons = 0;
  const SpreadWork spread = spread_work(lit(1e-4), fixed);
  EXPECT_EQ(spread.photons, 700'000u);
  EXPECT_EQ(spread.samples, 1);
}

/// Light paths cost at most as much as the rest of the picture, at least 4 samples remain in a pixel, and a record has
/// at least the rays that determine its radius.
TEST(SpreadWork, StaysWithinItsLimits) {
  AskedPicture picture = asked(1e-6);  // samples hardly err: as few as possible
  picture.work = 3e6;                  // 700 k further paths cost 1.4e6, three times as many 4.2e6
  const SpreadWork spread = spread_work(lit(0.01 * kPartPixels / 700'000), picture);
  EXPECT_EQ(spread.photons, 1'400'000u);
  EXPECT_NEAR(spread.samples, 1.0 / 8, 1e-12);
  picture.samples = 8;
  EXPECT_NEAR(spread_work(lit(0.01 * kPartPixels / 700'000), picture).samples, 1.0 / 2, 1e-12);
  picture.rays = 64;
  picture.ray_work = 1e9;
  EXPECT_EQ(spread_work(lit(0.01 * kPartPixels / 700'000), picture).rays, 64);
}

}  // namespace
}  // namespace tempolux
