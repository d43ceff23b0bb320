// Drawing cells by age: the probabilities of sequential draws, and the distribution of ages after many frames.
#include "lib/temporal/ageing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "formats/radsamples/sample.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

/// Probability that cells a, then b are drawn, by weights.
double probability(const std::array<double, 5>& weights, std::size_t a, std::size_t b) {
  double sum = 0;
  for (const double w : weights) sum += w;
  return weights[a] / sum * weights[b] / (sum - weights[a]);
}

/// 20 ordered pairs of five cells in 200000 draws: chi squared with 19 degrees of freedom is above 43.8 once in a
/// thousand runs.
TEST(AgeDraw, FollowsTheLawOfSequentialDraws) {
  const std::array<std::uint16_t, 5> ages{1, 2, 2, 5, 9};
  std::array<double, 5> weights{};
  for (std::size_t c = 0; c < 5; ++c) weights[c] = double(ages[c]) * double(ages[c]);
  constexpr int kDraws = 200000;
  std::map<std::pair<std::size_t, std::size_t>, int> counts;
  std::vector<std::uint32_t> drawn;
  for (int i = 0; i < kDraws; ++i) {
    draw_by_age(ages, 2, mix64(std::uint64_t(i)), drawn);
    ASSERT_EQ(drawn.size(), 2u);
    ++counts[{drawn[0], drawn[1]}];
  }
  double chi2 = 0;
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < 5; ++b) {
      if (a == b) continue;
      const double expected = kDraws * probability(weights, a, b);
      chi2 += std::pow(counts[{a, b}] - expected, 2) / expected;
    }
  EXPECT_LT(chi2, 43.8);
}

TEST(AgeDraw, DrawsEachOnceAndNeverMoreThanThereAre) {
  std::vector<std::uint16_t> ages;
  for (int c = 0; c < 300; ++c) ages.push_back(std::uint16_t(1 + c % 17));
  std::vector<std::uint32_t> drawn;
  draw_by_age(ages, 1000, 5, drawn);
  EXPECT_EQ(drawn.size(), 300u);
  EXPECT_EQ(std::set<std::uint32_t>(drawn.begin(), drawn.end()).size(), 300u);
  draw_by_age(ages, 0, 5, drawn);
  EXPECT_TRUE(drawn.empty());
}

// Cells whose age would no longer fit into the field are always drawn, and the others with the same probabilities.
TEST(AgeDraw, SaturatedAgesAreAlwaysDrawn) {
  const std::vector<std::uint16_t> ages{1, formats::kMaxAge, 4, formats::kMaxAge};
  std::vector<std::uint32_t> drawn;
  draw_by_age(ages, 0, 1, drawn);
  EXPECT_EQ(std::set<std::uint32_t>(drawn.begin(), drawn.end()), (std::set<std::uint32_t>{1, 3}));
  draw_by_age(ages, 3, 1, drawn);
  EXPECT_EQ(drawn.size(), 3u);
  EXPECT_EQ(std::set<std::uint32_t>(drawn.begin(), drawn.begin() + 2), (std::set<std::uint32_t>{1, 3}));
}

/// The steady state of 500 cells of which 50 are drawn in each frame (docs/methods/formulas.md). Ages count 1 in the
/// frame of the draw. stale: share of cells that were not drawn in a number of frames.
struct Steady {
  double mean = 0, above_10 = 0, above_20 = 0;
  std::array<double, 4> stale{};  ///< after 5, 10, 15, 20 frames
};

Steady steady() {
  constexpr int kCells = 500, kFrames = 4000, kWarm = 400;
  std::vector<std::uint16_t> ages;
  for (int c = 0; c < kCells; ++c) ages.push_back(std::uint16_t(1 + mix64(std::uint64_t(c)) % 10));
  std::vector<std::uint32_t> drawn;
  Steady made;
  std::array<int, 4> kept{};
  int blocks = 0;
  std::vector<int> last(kCells, -1);  // frame of the last draw
  int begin = kWarm;
  for (int f = 0; f < kFrames; ++f) {
    draw_by_age(ages, kCells / 10, mix64(std::uint64_t(f) + 77), drawn);
    for (std::uint16_t& age : ages) ++age;
    for (const std::uint32_t c : drawn) ages[c] = 1, last[c] = f;
    if (f < kWarm) continue;
    for (const std::uint16_t age : ages) {
      made.mean += double(age) / kCells / (kFrames - kWarm);
      made.above_10 += double(age > 10) / kCells / (kFrames - kWarm);
      made.above_20 += double(age > 20) / kCells / (kFrames - kWarm);
    }
    const int since = f - begin + 1;  // frames after a step of the light before frame `begin`
    for (std::size_t i = 0; i < 4; ++i)
      if (since == 5 * int(i + 1))
        for (const int l : last) kept[i] += l < begin;
    if (since == 20) begin = f + 1, ++blocks;
  }
  for (std::size_t i = 0; i < 4; ++i) made.stale[i] = double(kept[i]) / kCells / blocks;
  return made;
}

/// Within 2 %, or .002 where the share is only a few cells.
void expect_near(double found, double expected, const char* what) {
  EXPECT_NEAR(found, expected, 0.02 * expected + 0.002) << what;
}

TEST(AgeDraw, AgesInTheLongRunAreThoseOfTheTable) {
  const Steady square = steady();
  expect_near(square.mean, 6.16, "mean age, square");
  expect_near(square.above_10, 0.146, "above 10, square");
  expect_near(square.above_20, 0.0004, "above 20, square");
  const std::array<double, 4> of_square{0.510, 0.146, 0.015, 0.0003};
  for (std::size_t i = 0; i < 4; ++i) expect_near(square.stale[i], of_square[i], "stale, square");
}

}  // namespace
}  // namespace tempolux
