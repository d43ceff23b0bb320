// tests/lib/plan/estimate_test.cpp -- the arithmetic of --estimate, against what is computed on paper.
#include "lib/plan/estimate.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tempolux {
namespace {

TEST(Estimate, WorkScalesAndTheRestDoesNot) {
  const StageEstimate stage = scaled("s", 3, {.fixed_cpu_s = 0.5, .work_cpu_s = 0.2, .work = 10, .bytes = 100}, 40);
  EXPECT_DOUBLE_EQ(stage.work_cpu_s, 0.8);
  EXPECT_DOUBLE_EQ(stage.cpu_s(), 3 * 1.3);
  EXPECT_DOUBLE_EQ(stage.total_bytes(), 3 * 400);
}

TEST(Estimate, APowerLawGoesThroughItsTwoPoints) {
  EXPECT_NEAR(power_law(10, 100, 20, 200, 80), 800, 1e-9);   // in proportion
  EXPECT_NEAR(power_law(10, 100, 20, 100, 80), 100, 1e-9);   // constant
  EXPECT_NEAR(power_law(10, 100, 20, 90, 80), 90, 1e-9);     // never falls
  EXPECT_NEAR(power_law(10, 1, 20, 100, 40), 400, 1e-9);     // never faster than the pixels
  EXPECT_EQ(power_law(10, 5, 20, 0, 40), 0);
  EXPECT_NEAR(power_law(10, 0, 20, 7, 40), 14, 1e-9);
}

TEST(Estimate, TwoPilotsGiveTwoCosts) {
  // 0.1 s a record and 0.01 s a pixel.
  const TwoCosts both = two_costs(10, 100, 2, 15, 400, 5.5);
  EXPECT_NEAR(both.a, 0.1, 1e-12);
  EXPECT_NEAR(both.b, 0.01, 1e-12);
  // The same number of pieces of either kind twice: not told apart, the larger run decides.
  EXPECT_NEAR(two_costs(10, 10, 1, 20, 20, 2).a, 0.1, 1e-12);
  for (const TwoCosts& costs : {two_costs(10, 100, 5, 20, 400, 1), two_costs(10, 100, 0.1, 20, 110, 9)}) {
    EXPECT_GE(costs.a, 0);
    EXPECT_GE(costs.b, 0);
  }
}

TEST(Estimate, WallTimeIsThatOfTheBusierOfProcessorsAndJobs) {
  Estimate estimate;
  estimate.stages = {{"s", 8, 1, 2, 0}};  // 24 CPU s
  EXPECT_DOUBLE_EQ(estimate.cpu_s(), 24);
  EXPECT_DOUBLE_EQ(estimate.wall_s(1, 1, 1), 24);
  EXPECT_DOUBLE_EQ(estimate.wall_s(2, 1, 2), 8 * (1 + 2 / 2.0));  // one after the other
  EXPECT_DOUBLE_EQ(estimate.wall_s(2, 2, 2), 12);                 // both processors busy throughout
  EXPECT_DOUBLE_EQ(estimate.wall_s(64, 8, 2), 2);                 // all at once
}

TEST(Estimate, TextAndJsonHaveAllStages) {
  Estimate estimate;
  estimate.stages = {{"photon-trace", 2, 0.1, 1, 1e6}, {"frame-render", 4, 0.1, 2, 5e6}};
  const std::string text = estimate_text(estimate, 2, 1, 2);
  EXPECT_NE(text.find("photon-trace"), std::string::npos);
  EXPECT_NE(text.find("22.0 MB"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(estimate_json(estimate, 2, 1, 2));
  EXPECT_EQ(json["stages"].size(), 2u);
  EXPECT_EQ(json["bytes"], 22e6);
  EXPECT_DOUBLE_EQ(json["cpu_s"], 2 * 1.1 + 4 * 2.1);
}

}  // namespace
}  // namespace tempolux
