#include "lib/density/irradiance_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"

namespace tempolux {
namespace {

using formats::PathKind;
using formats::Photon;

constexpr double kPiD = std::numbers::pi;
constexpr Vec3 kUp{0, 0, 1};

Photon photon(Vec3 p, Rgb flux, Vec3 normal = kUp, PathKind kind = PathKind::indirect) {
  Photon result{.position = {p.x, p.y, p.z}, .flux = {flux.r, flux.g, flux.b}, .kind = kind};
  result.normal = formats::encode_normal({normal.x, normal.y, normal.z});
  return result;
}

IrradianceEstimate estimate(const std::vector<Photon>& photons, Vec3 point, const IrradianceOptions& options) {
  NeighbourList scratch;
  return estimate_irradiance(PhotonIndex(photons), point, kUp, options, scratch);
}

void expect_rgb(Rgbd got, Rgbd expected, double relative = 1e-6) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], relative * std::abs(expected[c]));
}

/// Three photons at distances 1, 2 and 3 with flux 1, 10 and 100.
const std::vector<Photon> kThree{photon({0, 3, 0}, {100, 0, -100}), photon({1, 0, 0}, {1, 0, -1}),
                                 photon({0, -2, 0}, {10, 0, -10})};

TEST(EstimateIrradiance, SumsTheKMinusOneNearestOverTheDiscOfTheKth) {
  const IrradianceEstimate e = estimate(kThree, {}, {.neighbours = 3});
  expect_rgb(e.irradiance, Rgbd{11, 0, -11} / (9 * kPiD));
  EXPECT_EQ(e.radius, 3);
  EXPECT_EQ(e.count, 2u);
}

TEST(EstimateIrradiance, SumsAllWithinTheLargestRadiusIfTheyAreFewerThanK) {
  const IrradianceEstimate few = estimate(kThree, {}, {.neighbours = 4, .max_radius = 5});
  expect_rgb(few.irradiance, Rgbd{111, 0, -111} / (25 * kPiD));
  EXPECT_EQ(few.radius, 5);
  EXPECT_EQ(few.count, 3u);
  expect_rgb(estimate(kThree, {}, {.neighbours = 3, .max_radius = 2.5f}).irradiance, Rgbd{11, 0, -11} / (6.25 * kPiD));
  expect_rgb(estimate(kThree, {}, {.neighbours = 3, .max_radius = 0.5f}).irradiance, Rgbd{});
}

TEST(EstimateIrradiance, WithoutEnoughPhotonsAndWithoutALargestRadiusIsZeroAndSaysSo) {
  for (const std::vector<Photon>& photons : {std::vector<Photon>{}, {photon({}, {1, 1, 1})}, kThree}) {
    const IrradianceEstimate e = estimate(photons, {}, {});
    EXPECT_EQ(e.irradiance, Rgbd{});
    EXPECT_EQ(e.radius, 0);
    EXPECT_EQ(e.count, 0u);
  }
  const IrradianceEstimate none = estimate({}, {}, {.max_radius = 2});
  EXPECT_EQ(none.irradiance, Rgbd{});
}

TEST(EstimateIrradiance, AllPhotonsInOnePointStayFiniteAndLoseNoFlux) {
  // All photons lie at one place, so r_k = 0. At 3 m the index resolves 3 * 2^-22 m, and all 1000 photons count over
  // a disc of that radius.
  const std::vector<Photon> photons(1000, photon({3, 1, -2}, {0.5f, 1, 2}));
  const IrradianceEstimate e = estimate(photons, {3, 1, -2}, {});
  const double radius = 3 * 0x1p-22;
  expect_rgb(e.irradiance, Rgbd{500, 1000, 2000} / (kPiD * radius * radius));
  EXPECT_EQ(e.count, 1000u);
  // At the origin floats resolve any size, so there is no estimate.
  const std::vector<Photon> origin(1000, photon({}, {1, 1, 1}));
  EXPECT_EQ(estimate(origin, {}, {}).irradiance, Rgbd{});
}

TEST(EstimateIrradiance, SumsInDouble) {
  // 510 photons of 1e-8 after one of 1, at k = 512: a sum in float would stay at 1, because half a step of 1 is 6e-8.
  std::vector<Photon> photons{photon({}, {1, 1, 1})};
  for (int i = 0; i < 511; ++i) photons.push_back(photon({1, 0, 0}, {1e-8f, 1e-8f, 1e-8f}));
  const double expected = (1 + 510 * double(1e-8f)) / kPiD;
  expect_rgb(estimate(photons, {}, {.neighbours = 512}).irradiance, Rgbd(expected), 1e-12);
}

TEST(EstimateIrradiance, SeparatesTheSidesOfAThinWallAndLeavesOutTheWallBesideAFloor) {
  // Bright side up (E = 1e4 * 1 W/m^2), dark side down and a wall at x = 0 with ten times the flux.
  std::vector<Photon> photons;
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const Vec2 u = PathRandom(3, i).get2(0, Purpose::test);
    photons.push_back(photon({u.x, u.y, 0}, Rgb(1)));
    photons.push_back(photon({u.x, u.y, -0.001f}, Rgb(100), {0, 0, -1}));
    photons.push_back(photon({0, u.x, u.y}, Rgb(10), {1, 0, 0}));
  }
  const PhotonIndex index(photons);
  NeighbourList scratch;
  const IrradianceOptions options{.neighbours = 400};
  // 400 neighbours: relative sigma 5 %, 4 sigma = 20 %
  EXPECT_NEAR(estimate_irradiance(index, {0.5f, 0.5f, 0}, kUp, options, scratch).irradiance.r, 1e4, 2e3);
  EXPECT_NEAR(estimate_irradiance(index, {0.5f, 0.5f, 0}, -kUp, options, scratch).irradiance.r, 1e6, 2e5);
  // In the corner half of the disc lies outside: half of the value, and no light of the wall.
  EXPECT_NEAR(estimate_irradiance(index, {0, 0.5f, 0}, kUp, options, scratch).irradiance.r, 5e3, 1e3);
  // Flattened tenfold, the sheet that faces down, one millimetre below the point, is 10 mm away.
  const double apart = estimate_irradiance(index, {0.5f, 0.5f, 0}, -kUp, {.max_radius = 0.0099f}, scratch).irradiance.r;
  EXPECT_EQ(apart, 0);
}

// --- mean over uniform photons -------------------------------------------------------------------------

/// n uniform photons on the unit square, continued periodically: E = 1 W/m^2 everywhere. The border holds
/// copies of what lies within 0.02 of the opposite edge, more than any radius used here.
std::vector<Photon> periodic_plane(std::uint64_t seed, std::uint64_t n) {
  std::vector<Photon> photons;
  for (std::uint64_t i = 0; i < n; ++i) {
    const Vec2 u = PathRandom(seed, i).get2(0, Purpose::test);
    for (float x : {u.x - 1, u.x, u.x + 1})
      for (float y : {u.y - 1, u.y, u.y + 1})
        if (x > -0.02f && x < 1.02f && y > -0.02f && y < 1.02f)
          photons.push_back(photon({x, y, 0.5f}, Rgb(1.0f / float(n))));
  }
  return photons;
}

TEST(EstimateIrradiance, HasNoBiasOnAPlaneOfUniformPhotons) {
  // One estimate has relative variance 1/(k-2) at most for each rule here: (0.144)^2 at k = 50. 20 planes of
  // 200 000 photons hold 80 000 disjoint discs of 50, so the mean's sigma is at most 0.144/sqrt(80 000) =
  // 0.05 %, and 0.2 % is 4 sigma. Mistakes: k for k-1 is +2.0 % (all of k50), dividing by the disc of the
  // farthest found instead of the largest radius +1.5 % or more (truncated).
  constexpr std::uint64_t kPhotons = 200000;
  const double mean50 = std::sqrt(50 / (kPiD * kPhotons));  // the radius that holds 50 in the mean
  struct Rule {
    const char* name;
    IrradianceOptions options;
    double sum;
  };
  const float half = float(mean50), less = float(0.9 * mean50);
  std::vector<Rule> rules{{"k50", {.neighbours = 50}, 0},
                          {"truncated for half", {.neighbours = 50, .max_radius = half}, 0},
                          {"truncated for most", {.neighbours = 50, .max_radius = less}, 0}};
  constexpr int kPlanes = 20, kQueries = 20000;
  NeighbourList scratch;
  for (std::uint64_t plane = 0; plane < kPlanes; ++plane) {
    const PhotonIndex index(periodic_plane(plane, kPhotons));
    for (std::uint64_t q = 0; q < kQueries; ++q) {
      // stratified: 200 x 100 cells
      const Vec2 u = PathRandom(100 + plane, q).get2(1, Purpose::test);
      const Vec3 point{(float(q / 100) + u.x) / 200, (float(q % 100) + u.y) / 100, 0.5f};
      for (Rule& rule : rules) rule.sum += estimate_irradiance(index, point, kUp, rule.options, scratch).irradiance.g;
    }
  }
  for (const Rule& rule : rules) {
    const double mean = rule.sum / (double(kPlanes) * kQueries);
    EXPECT_NEAR(mean, 1, 0.002) << rule.name;
    RecordProperty(rule.name, std::to_string(mean));
  }
}

TEST(EstimateIrradiance, RefusesOptionsOutOfRange) {
  const PhotonIndex index;
  NeighbourList scratch;
  const auto refuses = [&](IrradianceOptions options) {
    EXPECT_THROW(estimate_irradiance(index, {}, kUp, options, scratch), std::invalid_argument);
  };
  refuses({.neighbours = 1});
  refuses({.neighbours = kMaxNeighbours + 1});
  refuses({.max_radius = 0});
  refuses({.max_radius = std::numeric_limits<float>::quiet_NaN()});
}

}  // namespace
}  // namespace tempolux
