// Jumps of light between frames, against steps that are counted by hand.
#include "lib/temporal/light_jumps.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

/// Four frames with one point lamp of these intensities and, if `shifts` are not 0, a moving square of diagonal 1 at
/// these places.
bool jumps(const std::array<float, 4>& intensities, const std::array<float, 4>& shifts = {}) {
  std::array<LightScene, 4> scenes;
  for (std::size_t i = 0; i < 4; ++i) {
    scenes[i].add(PunctualLight::Kind::point, Rgb(intensities[i]), {}, {0, 0, -1});
    const float s = std::sqrt(0.5f), x = shifts[i];
    scenes[i].add({{x, 0, 0}, {x + s, 0, 0}, {x + s, s, 0}, {x, s, 0}}, Rgb(0.0f));
    scenes[i].frame.static_count = 0;
  }
  return light_jumps({&scenes[0].frame, &scenes[1].frame, &scenes[2].frame, &scenes[3].frame});
}

/// Steps of the lamp, as shares of the larger flux, between frames 0, 1, 2, 3.
TEST(LightJumps, LampsByTheirSteps) {
  EXPECT_FALSE(jumps({1, 1, 1, 1}));
  EXPECT_TRUE(jumps({1, 1, 0.9f, 0.9f})) << "0, .1, 0: .1 is above 1/16";
  EXPECT_FALSE(jumps({1, 1, 0.95f, 0.95f})) << "0, .05, 0: .05 is below 1/16";
  EXPECT_FALSE(jumps({1, 0.8f, 0.6f, 0.4f})) << ".2, .25, .33: a lamp that dims steadily";
  EXPECT_FALSE(jumps({1, 1, 0.8f, 0.6f})) << "0, .2, .25: the start of dimming";
  EXPECT_TRUE(jumps({1, 1, 0.4f, 0.36f})) << "0, .6, .1: .6 is above 2 x .1";
}

TEST(LightJumps, AllLampsOnOrOffIsAJumpHoweverWeak) {
  EXPECT_TRUE(jumps({2e-3f, 1e-3f, 0, 0}));
  EXPECT_TRUE(jumps({0, 0, 1e-3f, 2e-3f}));
  EXPECT_FALSE(jumps({0, 0, 0, 0}));
}

/// Steps of a square of diagonal 1, in diagonals.
TEST(LightJumps, SurfacesByTheirSteps) {
  const std::array<float, 4> lit{1, 1, 1, 1};
  EXPECT_TRUE(jumps(lit, {0, 0, 0.1f, 0.1f})) << "put elsewhere";
  EXPECT_FALSE(jumps(lit, {0, 0, 0.05f, 0.05f})) << "less than 1/16 of its size";
  EXPECT_FALSE(jumps(lit, {0, 0.1f, 0.2f, 0.3f})) << "moves steadily";
  EXPECT_FALSE(jumps(lit, {0, 0, 0.1f, 0.2f})) << "starts to move";
}

TEST(LightJumps, NothingBeforeIsNoJump) {
  LightScene scene;
  EXPECT_FALSE(light_jumps({nullptr, nullptr, &scene.frame, nullptr}));
}

}  // namespace
}  // namespace tempolux
