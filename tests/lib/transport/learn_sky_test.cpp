// The sky through a window: what places learn, and the irradiance at a place with and without it.
#include "lib/transport/learn_sky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/core/sampling.h"
#include "lib/transport/direct_light.h"
#include "lib/transport/media.h"
#include "tests/support/materials.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::place_at;

constexpr Vec3 kUp{0, 1, 0};
const Material kWall = matte(Rgb(0.5f));

/// A floor of 8 x 8 m below a ceiling at height 3; walls of full height on three sides, and one on the fourth side that
/// leaves a slit of half a metre below the ceiling, open or behind a pane.
struct Room {
  HandMadeScene scene;
  Environment sky;
  SceneFrame frame;
  explicit Room(float radiance = 1, bool pane = false) : scene(walls(pane)), frame(scene.frame()) {
    sky.width = sky.height = 1;
    sky.radiance.push_back(Rgb(radiance));
    frame.environment = &sky;
  }
  /// The floor, the ceiling and the three walls of full height.
  static HandMadeScene three_walls() {
    HandMadeScene scene;
    scene.add_quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, kWall);
    scene.add_quad({-4, 3, -4}, {4, 3, -4}, {4, 3, 4}, {-4, 3, 4}, kWall);
    scene.add_quad({-4, 0, -4}, {4, 0, -4}, {4, 3, -4}, {-4, 3, -4}, kWall);
    scene.add_quad({-4, 0, 4}, {-4, 0, -4}, {-4, 3, -4}, {-4, 3, 4}, kWall);
    scene.add_quad({4, 0, -4}, {4, 0, 4}, {4, 3, 4}, {4, 3, -4}, kWall);
    return scene;
  }
  static HandMadeScene walls(bool pane) {
    HandMadeScene scene = three_walls();
    scene.add_quad({4, 0, 4}, {-4, 0, 4}, {-4, 2.5f, 4}, {4, 2.5f, 4}, kWall);
    if (pane) scene.add_quad({4, 2.5f, 4}, {-4, 2.5f, 4}, {-4, 3, 4}, {4, 3, 4}, test::glass(0, true));
    return scene;
  }
  static std::vector<SeenPlace> floor() {
    std::vector<SeenPlace> places;
    for (int i = 0; i < 4096; ++i)
      places.push_back({place_at({float(i % 64) / 9 - 3.5f, 0, float(i / 64) / 9 - 3.5f}, kUp), kUp, kUp});
    return places;
  }
};

struct Mean {
  double mean = 0, error = 0;
};
Mean irradiance(const Tracer& tracer, const Lights& lights, const SurfacePoint& place, std::uint32_t n,
                std::uint64_t seed = 1) {
  double sum = 0, squares = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const PathRandom random(seed, i);
    DirectSample direct;
    if (!sample_direct(lights, {place, kUp, kUp}, random.get1(0, Purpose::light_choice),
                       random.get2(0, Purpose::light_point), direct))
      continue;
    const double e = double(direct.irradiance.g * transmittance(tracer, direct.shadow, {random, 0, way_shadow}).g);
    sum += e;
    squares += e * e;
  }
  return {sum / n, std::sqrt((squares / n - sum / n * sum / n) / n)};
}

TEST(LearnSky, SameIrradianceWithLessNoise) {
  const SurfacePoint place = place_at({0.4f, 0, 1.1f}, kUp);
  for (const bool pane : {false, true}) {
    const Room room(1, pane);
    const Tracer tracer(room.frame);
    const Lights plain(room.frame, build_emission_table({&room.frame, 1}));
    const auto guide = learn_sky(tracer, plain, Room::floor());
    ASSERT_NE(guide, nullptr) << pane;
    const Mean a = irradiance(tracer, plain, place, 1 << 17),
               b = irradiance(tracer, plain.guided(guide), place, 1 << 15);
    EXPECT_GT(a.mean, 0) << pane;
    EXPECT_NEAR(a.mean, b.mean, 3 * std::hypot(a.error, b.error)) << pane;
    // With a quarter of the samples: less than a quarter of the variance of a sample.
    EXPECT_LT(b.error, a.error) << pane;
  }
}

/// The mean over the floor of the irradiance that the guide has learned, against light samples without a guide. The
/// grids of the first rays are made from the hits that they weigh, so the learned irradiance is a little low. Seen to
/// fail: hits of the first rays that keep their weights beside the second rays (1.29).
TEST(LearnSky, IrradianceIsThatOfLightSamples) {
  const Room room;
  const Tracer tracer(room.frame);
  const Lights plain(room.frame, build_emission_table({&room.frame, 1}));
  const std::vector<SeenPlace> floor = Room::floor();
  const auto guide = learn_sky(tracer, plain, floor);
  double learned = 0, sampled = 0;
  for (std::size_t i = 0; i < floor.size(); ++i) {
    learned += guide->at(floor[i].surface.position, kUp)->irradiance;
    sampled += irradiance(tracer, plain, floor[i].surface, 64, i).mean;
  }
  EXPECT_GT(learned, 0.8 * sampled);
  EXPECT_LT(learned, 1.1 * sampled);
}

/// A room of the same size with a window of .3 x .3 m, which one of 2000 rays of the floor meets: four rays of each
/// place make seven hits. The window is small, so the irradiance is L A cos cos' / d^2 within (.3 / d)^2. A sample that
/// always meets the window has a relative deviation below 1. Three quarters of the samples come from a grid, and half
/// of these samples shall meet the window. Seen to fail: no search, the median deviation is 50.
TEST(LearnSky, FindsASmallWindow) {
  const Room room;
  HandMadeScene scene = Room::three_walls();
  const float low = 1.5f, high = 1.8f, half = 0.15f;
  scene.add_quad({4, 0, 4}, {-4, 0, 4}, {-4, low, 4}, {4, low, 4}, kWall);
  scene.add_quad({4, high, 4}, {-4, high, 4}, {-4, 3, 4}, {4, 3, 4}, kWall);
  scene.add_quad({4, low, 4}, {half, low, 4}, {half, high, 4}, {4, high, 4}, kWall);
  scene.add_quad({-half, low, 4}, {-4, low, 4}, {-4, high, 4}, {-half, high, 4}, kWall);
  SceneFrame frame = scene.frame();
  frame.environment = &room.sky;
  const Tracer tracer(frame);
  const Lights plain(frame, build_emission_table({&frame, 1})),
      lights = plain.guided(learn_sky(tracer, plain, Room::floor()));
  double sum = 0, errors2 = 0, paper = 0;
  std::vector<double> deviations;
  for (int i = 0; i < 64; ++i) {
    const Vec3 at{float(i % 8) - 3.5f, 0, float(i / 8) - 3.5f}, to = Vec3{0, (low + high) / 2, 4} - at;
    const std::uint32_t n = 1 << 12;
    const Mean guided = irradiance(tracer, lights, place_at(at, kUp), n, std::uint64_t(i));
    sum += guided.mean;
    errors2 += guided.error * guided.error;
    const double d2 = dot(to, to), expected = 0.09 * double(to.y * to.z) / (d2 * d2);
    paper += expected;
    deviations.push_back(guided.error * std::sqrt(n) / expected);
  }
  EXPECT_NEAR(sum, paper, 3 * std::sqrt(errors2) + 0.01 * paper);
  std::ranges::nth_element(deviations, deviations.begin() + 32);
  EXPECT_LT(deviations[32], 4);
}

TEST(LearnSky, DoesNotDependOnThreadsAndNeedsASky) {
  const Room room, night(0);
  const Tracer tracer(room.frame);
  const Lights lights(room.frame, build_emission_table({&room.frame, 1})),
      dark(night.frame, build_emission_table({&night.frame, 1}));
  EXPECT_EQ(learn_sky(tracer, dark, Room::floor()), nullptr);
  const auto densities = [&](int threads) {
    const ThreadLimit limit(threads);
    const auto guide = learn_sky(tracer, lights, Room::floor());
    std::vector<double> found;
    for (const SeenPlace& place : Room::floor()) {
      const SkyGuide::Grid* const grid = guide->grid_of(guide->at(place.surface.position, kUp));
      found.push_back(grid ? grid->pdf_solid_angle(normalize(Vec3{0.1f, 0.3f, 1})) : -1);
    }
    return found;
  };
  EXPECT_EQ(densities(1), densities(2));
}

}  // namespace
}  // namespace tempolux
