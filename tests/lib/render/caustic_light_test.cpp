// Caustic light by density estimation on objects smaller than the disc of the estimate.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/halton.h"
#include "lib/core/sampling.h"
#include "lib/points/point_density.h"
#include "lib/render/photon_light.h"
#include "tests/support/materials.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

Rgb caustic_at(const PhotonLight& light, Vec3 position, const LitSurface& surface) {
  return light.caustic(position, surface).irradiance;
}
/// Irradiance at a place of a level floor.
Rgb on_floor(const FootprintDensity& density, Vec3 position) {
  return density.estimate(position, LitSurface(Vec3{0, 1, 0})).irradiance;
}

std::vector<formats::Photon> trace(const Tracer& tracer, const Lights& lights, std::uint64_t count,
                                   std::uint64_t seed) {
  PhotonOptions options;
  options.photon_count = count;
  options.seed = seed;
  return test::photons_of(PhotonTracer(tracer, lights, options));
}
/// Transmittance of a plate: (1 - F) / (1 + F), with both faces and all reflections between them.
double plate_transmittance(double mu) {
  const double c = std::sqrt(1 - (1 - mu * mu) / 2.25);
  const double rs = (mu - 1.5 * c) / (mu + 1.5 * c), rp = (1.5 * mu - c) / (1.5 * mu + c), f = (rs * rs + rp * rp) / 2;
  return (1 - f) / (1 + f);
}

/// A lamp 4 m above a black floor, under a plate of glass 1 mm thick, lights a black post 0.1 m wide and 1 m high at a
/// distance of 2 m. On its lit face E = I T(mu) cos / d^2. Some 30 photons of a map lie on this face, and 20 photons
/// need 0.3 m: the disc is mostly empty. 60 maps of 40000 photons have 2000 photons on the face, 2.5 % of noise; an
/// uncorrected disc finds less than half of the light.
TEST(CausticLight, IsRightOnAPostThinnerThanTheDisc) {
  HandMadeScene scene;
  scene.add_open_box({-9, 3, -9}, {9, 3.001f, 9}, test::glass(0));
  scene.add_quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, matte(Rgb(0.0f)));
  constexpr float kNear = 2, kFar = 2.1f, kHalf = 0.05f;
  scene.add(
      {{kNear, 0, -kHalf},
       {kNear, 0, kHalf},
       {kNear, 1, kHalf},
       {kNear, 1, -kHalf},
       {kFar, 0, -kHalf},
       {kFar, 0, kHalf},
       {kFar, 1, kHalf},
       {kFar, 1, -kHalf}},
      {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}, {1, 5, 6}, {1, 6, 2}, {0, 7, 4}, {0, 3, 7}, {3, 2, 6}, {3, 6, 7}},
      matte(Rgb(0.0f)));
  scene.add_point_light({0, 4, 0}, Rgb(1.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  double found = 0, expected = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const FootprintDensity light(tracer, trace(tracer, lights, 40000, seed),
                                 {.neighbours = 25, .max_radius = 0.3f, .asked = kAskedPhotons},
                                 kind_bit(formats::PathKind::caustic));
    for (int i = 0; i < 100; ++i) {
      const float y = (float(i) + 0.5f) / 100, z = kHalf * (float(i * 37 % 100) / 50 - 0.99f);
      const double d2 = 4.0 + double((4 - y) * (4 - y) + z * z), d = std::sqrt(d2);
      expected += plate_transmittance(double(4 - y) / d) * 2 / d / d2;
      found += double(light.estimate({kNear, y, z}, LitSurface(Vec3{-1, 0, 0})).irradiance.g);
    }
    for (float z : {-0.04f, 0.0f, 0.04f})
      EXPECT_EQ(light.estimate({kFar, 0.5f, z}, LitSurface(Vec3{1, 0, 0})).irradiance.g, 0) << "the far face is dark";
  }
  EXPECT_NEAR(found / expected, 1, 0.06);
}

/// Light of irradiance 1 straight down on the steps of a stair 0.1 m deep and 0.02 m high, with 12 photons on each.
/// Light that falls on a step stays on it and on reachable steps, so the mean over places on steps is 1. 200 maps with
/// 40 places each; neighbouring places share photons: some 200 x 5 independent values with 25 % noise, 1 %.
TEST(CausticLight, KeepsItsMeanOnAStair) {
  HandMadeScene scene;
  std::vector<Vec3> p;
  std::vector<std::array<std::uint32_t, 3>> t;
  constexpr int kSteps = 8;
  for (int s = 0; s < kSteps; ++s)
    for (float x : {0.1f * float(s), 0.1f * float(s + 1)})
      for (float z : {-1.f, 1.f}) p.push_back({x, 0.02f * float(s), z});
  for (std::uint32_t i = 0; i + 2 < p.size(); i += 2) t.insert(t.end(), {{i, i + 1, i + 3}, {i, i + 3, i + 2}});
  scene.add(p, t, matte(Rgb(0.0f)));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const auto up = formats::encode_normal({0, 1, 0});
  constexpr int kPhotons = kSteps * 100;
  double all = 0, sum = 0;  // by the k nearest of a place, by footprints
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const PathRandom random(seed, 3);
    std::vector<formats::Photon> photons;
    for (std::uint32_t i = 0; i < kPhotons; ++i) {
      const Vec2 u = random.get2(i, Purpose::test);
      const float x = 0.1f * kSteps * u.x, y = 0.02f * std::floor(x / 0.1f), flux = 0.2f * kSteps / kPhotons;
      photons.push_back({{x, y, 2 * u.y - 1}, {flux, flux, flux}, up, 0, formats::PathKind::caustic, 1});
    }
    const PointDensity nearest(tracer, photons, {.neighbours = 20, .max_radius = 0.4f, .area_probes = 32});
    const FootprintDensity density(tracer, photons, {.neighbours = 20, .max_radius = 0.4f});
    for (int i = 0; i < 40; ++i) {
      const int step = 2 + i % 4;
      const Vec3 at{0.1f * (float(step) + (float(i) + 0.5f) / 40), 0.02f * float(step), -0.4f + 0.02f * float(i)};
      all += double(nearest.estimate({at, {0, 1, 0}}, PathRandom(seed, std::uint64_t(i))).irradiance.g);
      sum += double(on_floor(density, at).g);
    }
  }
  EXPECT_NEAR(all / 8000, 1, 0.04);
  EXPECT_NEAR(sum / 8000, 1, 0.04);
  EXPECT_NEAR(sum / all, 1, 0.02);
}

/// Irradiance 1 straight down on a floor, by independent photons, and by photons that are as stratified as Halton's
/// sequence after a plane mirror. A density of the k nearest would be too dark by 1 / (2 k) in the second case. 5000
/// places have about 20000 x 3/4 / 30 independent values with 21 % noise in the first case, 0.5 % in the mean of four
/// maps; the limit is 3.5 of these. Stratified photons have a third of the noise.
TEST(CausticLight, IsUnbiasedForIndependentAndForEvenlySpreadPhotons) {
  HandMadeScene scene;
  scene.add_quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, matte(Rgb(0.0f)));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const auto up = formats::encode_normal({0, 1, 0});
  constexpr std::uint32_t kPhotons = 20000;
  for (const bool even : {false, true}) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const PathRandom random(seed, 5);
      std::vector<formats::Photon> photons;
      const RadicalInverse x(2, seed), z(7, seed);
      for (std::uint32_t i = 0; i < kPhotons; ++i) {
        const Vec2 u = even ? Vec2{float(x(i)), float(z(i))} : random.get2(i, Purpose::test);
        const float flux = 4.0f / kPhotons;
        photons.push_back({{2 * u.x - 1, 0, 2 * u.y - 1}, {flux, flux, flux}, up, 0, formats::PathKind::caustic, 1});
      }
      const FootprintDensity density(tracer, photons, {.neighbours = 30, .max_radius = 0.2f});
      for (std::uint32_t i = 0; i < 5000; ++i) {
        const Vec2 u = random.get2(kPhotons + i, Purpose::test);
        sum += double(on_floor(density, {1.6f * u.x - 0.8f, 0, 1.6f * u.y - 0.8f}).g);
      }
    }
    EXPECT_NEAR(sum / 20000, 1, even ? 0.01 : 0.018) << (even ? "even" : "independent");
  }
}

/// Adds 1000 photons on a disc around the origin, which arrive from above.
void add_spot(float radius, float flux, std::vector<formats::Photon>& photons) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Vec2 d = sample_disc_concentric(PathRandom(1, 7).get2(i, Purpose::test));
    photons.push_back({{radius * d.x, 0, radius * d.y},
                       {flux, flux, flux},
                       formats::encode_normal({0, 1, 0}),
                       0,
                       formats::PathKind::caustic,
                       1});
  }
}

/// Spots keep their light: 1000 photons with 1 W in all lie on a disc of radius 1 m on a floor, once without and once
/// with a thin wall through the middle. E is summed over a grid of 0.02 m. This is a fraction of the least radius,
/// 0.16 m; the sum of a paraboloid of this width has an error of 1e-3. The sum is 1 W, and with the wall the flux of
/// the photons on either side. Areas of footprints at the wall are estimated: 20 % of noise for about 400 photons, 1
/// % of the sum; the limit is 2.5 of these. The 25 nearest photons of each place would give 1.08 to 1.12 (see
/// FootprintDensity).
TEST(CausticLight, SpotsKeepTheirLight) {
  for (const bool wall : {false, true}) {
    HandMadeScene scene;
    scene.add_quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, matte(Rgb(0.0f)));
    if (wall) scene.add_quad({0.3f, 0, 4}, {0.3f, 0, -4}, {0.3f, 1, -4}, {0.3f, 1, 4}, matte(Rgb(0.0f)));
    const SceneFrame& frame = scene.frame();
    const Tracer tracer(frame);
    std::vector<formats::Photon> photons;
    add_spot(1, 1e-3f, photons);
    double left = 0;
    for (const formats::Photon& photon : photons) left += photon.position[0] < 0.3f ? 1e-3 : 0;
    const FootprintDensity density(tracer, photons, {.neighbours = 25, .max_radius = 2});
    double sum = 0, sum_left = 0, farthest = 0;
    constexpr float kStep = 0.02f;
    for (float x = -3.99f; x < 4; x += kStep)
      for (float z = -3.99f; z < 4; z += kStep) {
        const auto here = double(on_floor(density, {x, 0, z}).g * kStep * kStep);
        sum += here;
        if (x < 0.3f) sum_left += here;
        if (here > 0) farthest = std::max(farthest, double(std::hypot(x, z)));
      }
    EXPECT_NEAR(sum, 1, wall ? 0.025 : 0.002);
    if (wall) { EXPECT_NEAR(sum_left, left, 0.025 * left); }
    EXPECT_LT(farthest, 1.5) << "a photon at the rim has k neighbours within twice the radius of one in the middle";
  }
}

/// In a scene of kilometres, photons are closer together than float positions resolve heights. Each photon counts as
/// a whole disc, as wide as the distance of its neighbours. 1 W in a spot of 0.02 m, summed over a grid of 0.002 m.
TEST(CausticLight, SpotsStaySharpInLargeScenes) {
  HandMadeScene scene;
  scene.add_quad({-4000, 0, 4000}, {4000, 0, 4000}, {4000, 0, -4000}, {-4000, 0, -4000}, matte(Rgb(0.0f)));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  std::vector<formats::Photon> photons;
  add_spot(0.01f, 1e-3f, photons);
  const FootprintDensity density(tracer, photons, {.neighbours = 25, .max_radius = 1});
  double sum = 0;
  for (float x = -0.0299f; x < 0.03f; x += 0.002f)
    for (float z = -0.0299f; z < 0.03f; z += 0.002f) sum += double(on_floor(density, {x, 0, z}).g) * 4e-6;
  EXPECT_NEAR(sum, 1, 0.02);
}

/// Without a caustic photon nothing is built and no light is found.
TEST(CausticLight, IsNothingWithoutItsPhotons) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.5f)));
  const Tracer tracer(scene.frame());
  const std::vector<formats::Photon> photons{
      {{0, 0, 0}, {1, 1, 1}, formats::encode_normal({0, 1, 0}), 0, formats::PathKind::indirect, 1}};
  PhotonLightOptions options;
  options.caustic_only = true;
  const PhotonLight light(tracer, photons, {}, options);
  EXPECT_EQ(light.photon_count(), 0u);
  EXPECT_EQ(caustic_at(light, {0, 0, 0}, LitSurface(Vec3{0, 1, 0})).g, 0);
}

/// 4000 photons of three colours on a floor of 2 m with a wall across it. Footprints at the wall are cut, and photons
/// behind the wall reach no place in front of it.
struct CutFootprints {
  HandMadeScene scene;
  std::vector<formats::Photon> photons;
  CutFootprints() {
    scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.0f)));
    scene.add_quad({0, 0, -1}, {0, 0, 1}, {0, 1, 1}, {0, 1, -1}, matte(Rgb(0.0f)));
    const auto up = formats::encode_normal({0, 1, 0});
    const PathRandom random(5, 5);
    for (std::uint32_t i = 0; i < 4000; ++i) {
      const Vec2 u = random.get2(i, Purpose::test);
      std::array<float, 3> flux{};
      flux[i % 3] = 1e-3f * float(1 + i % 5);
      photons.push_back({{2 * u.x - 1, 0, 2 * u.y - 1}, flux, up, 0, formats::PathKind::caustic, 1});
    }
  }
};

/// Four of some 25 photons are tested, drawn by their contribution: the mean over 80000 places within 5 cm of the wall
/// equals that of testing all. A place's channel deviates by about .7 of itself, because each of the four has one of
/// three colours: .7 / sqrt(80000) = .25 %; the limit is four of these. Away from the wall no photon is tested. Seen to
/// fail: drawn light counted as if drawn uniformly (1.66 to 1.70).
TEST(CausticLight, AFewPhotonsAskedHaveTheMeanOfAll) {
  CutFootprints made;
  const Tracer tracer(made.scene.frame());
  const FootprintDensity all(tracer, made.photons, {.max_radius = 0.3f}),
      few(tracer, made.photons, {.max_radius = 0.3f, .asked = 4});
  const PathRandom random(6, 6);
  Rgbd sum_all{0.0}, sum_few{0.0};
  for (std::uint32_t i = 0; i < 80000; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    const Vec3 near{0.1f * (u.x - 0.5f), 0, 1.6f * (u.y - 0.5f)}, away{0.5f + 0.1f * u.x, 0, 1.2f * (u.y - 0.5f)};
    sum_all += Rgbd(on_floor(all, near));
    sum_few += Rgbd(on_floor(few, near));
    if (i < 100) { EXPECT_EQ(on_floor(all, away).g, on_floor(few, away).g); }
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum_few[c] / sum_all[c], 1, 0.01) << c;
}

/// 4000 photons of equal flux, spread at random over a floor of 2 m: the mean square of the noise is at most the
/// variance of the irradiance, and at least half of it. It counts the photons that light a place, but not that their
/// footprints are narrower where photons happen to be dense, which adds variance. Footprints of 25 photons are .18 m
/// wide, so the 64 places of a map, .2 m apart, are nearly independent, and 20 maps give both figures within 4 %.
/// Photons with one common sign would give the irradiance itself: 20 times as much.
TEST(CausticLight, NoiseHasTheVarianceBetweenMaps) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.0f)));
  const Tracer tracer(scene.frame());
  const auto up = formats::encode_normal({0, 1, 0});
  double sum = 0, square = 0, noise_square = 0;
  int n = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const PathRandom random(seed, 9);
    std::vector<formats::Photon> photons;
    for (std::uint32_t i = 0; i < 4000; ++i) {
      const Vec2 u = random.get2(i, Purpose::test);
      photons.push_back({{2 * u.x - 1, 0, 2 * u.y - 1}, {1, 1, 1}, up, 0, formats::PathKind::caustic, 1});
    }
    const PhotonLight light(tracer, photons, {}, {.caustic_only = true});
    for (float x = -0.7f; x < 0.8f; x += 0.2f)
      for (float z = -0.7f; z < 0.8f; z += 0.2f, ++n) {
        const FootprintLight here = light.caustic({x, 0, z}, LitSurface(Vec3{0, 1, 0}));
        const auto irradiance = double(here.irradiance.g), noise = double(here.noise.g);
        sum += irradiance, square += irradiance * irradiance, noise_square += noise * noise;
      }
  }
  const double mean = sum / n, variance = square / n - mean * mean;
  EXPECT_NEAR(mean / 1000, 1, 0.03);
  EXPECT_GT(noise_square / n / variance, 0.5);
  EXPECT_LT(noise_square / n / variance, 1.08);
}

/// A dense spot among sparse photons: within the reported distance, no footprint is narrower than four times that
/// distance, checked with all photons' distances to their 6th neighbours.
TEST(CausticLight, IsAlikeOnlyAwayFromNarrowFootprints) {
  HandMadeScene scene;
  scene.add_quad({-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, matte(Rgb(0.0f)));
  const Tracer tracer(scene.frame());
  const auto up = formats::encode_normal({0, 1, 0});
  const PathRandom random(8, 8);
  std::vector<formats::Photon> photons;
  for (std::uint32_t i = 0; i < 600; ++i) {
    const Vec2 u = random.get2(i, Purpose::test);
    const float wide = i < 200 ? 4 : i < 400 ? 0.2f : 0.01f;
    photons.push_back({{wide * (u.x - 0.5f), 0, wide * (u.y - 0.5f)}, {1, 1, 1}, up, 0, formats::PathKind::caustic, 1});
  }
  constexpr int kNeighbours = 6;
  const FootprintDensity density(tracer, photons, {.neighbours = kNeighbours, .max_radius = 1});
  const auto distance = [](const std::array<float, 3>& a, Vec3 b) { return length(Vec3{a[0], a[1], a[2]} - b); };
  std::vector<float> radius;
  for (const formats::Photon& p : photons) {
    std::vector<float> others;
    for (const formats::Photon& q : photons)
      others.push_back(distance(q.position, {p.position[0], p.position[1], p.position[2]}));
    std::nth_element(others.begin(), others.begin() + kNeighbours, others.end());
    radius.push_back(std::min(1.0f, others[kNeighbours]));
  }
  int said = 0;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Vec2 u = random.get2(1000 + i, Purpose::test);
    const float wide = i % 3 == 0 ? 3 : i % 3 == 1 ? 0.3f : 0.03f;
    const Vec3 place{wide * (u.x - 0.5f), 0, wide * (u.y - 0.5f)};
    const float within = density.estimate(place, LitSurface(Vec3{0, 1, 0})).alike_within;
    said += within > 0;
    for (std::size_t k = 0; k < photons.size(); ++k) {
      if (radius[k] < 4 * within * 0.999f) {
        EXPECT_GT(distance(photons[k].position, place), within + radius[k] * 0.999f);
      }
    }
  }
  EXPECT_GT(said, 2000);
}

/// While a memory lives, a place has the light of a close remembered place, of its own half only. A place far away, a
/// place with another orientation, and all places without a memory have their own light.
TEST(CausticLight, APixelRemembersItsPlace) {
  CutFootprints made;
  const Tracer tracer(made.scene.frame());
  const PhotonLight light(tracer, made.photons, {}, {.caustic_only = true});
  const LitSurface up(Vec3{0, 1, 0});
  const Vec3 first{0.5f, 0, 0.1f}, beside{0.5001f, 0, 0.1f}, far{0.7f, 0, 0.1f};
  const float here = caustic_at(light, first, up).g, there = caustic_at(light, beside, up).g,
              away = caustic_at(light, far, up).g;
  ASSERT_NE(here, there);
  {
    CausticMemory memory;
    EXPECT_EQ(caustic_at(light, first, up).g, here);
    EXPECT_EQ(caustic_at(light, beside, up).g, here);
    EXPECT_EQ(caustic_at(light, far, up).g, away);
    EXPECT_EQ(caustic_at(light, beside, LitSurface(Vec3{0, -1, 0})).g, 0);
    memory.use_half(1);
    EXPECT_EQ(caustic_at(light, beside, up).g, there);
    EXPECT_EQ(caustic_at(light, first, up).g, there);
  }
  EXPECT_EQ(caustic_at(light, first, up).g, here);
  CausticMemory next;
  EXPECT_EQ(caustic_at(light, beside, up).g, there) << "of a pixel before";
}

}  // namespace
}  // namespace tempolux
