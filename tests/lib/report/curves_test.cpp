// tests/lib/report/curves_test.cpp -- fits and speed-ups on curves whose slope, floor and ratio are known.
#include "lib/report/curves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/random.h"

namespace tempolux {
namespace {

/// Points at t = first, first*step, ... with e^2 = a t^(2 slope) + b.
std::vector<CurvePoint> power_curve(int count, double a, double slope, double b, double first = 0.1, double step = 4) {
  std::vector<CurvePoint> points;
  for (int i = 0; i < count; ++i) {
    const double t = first * std::pow(step, i);
    points.push_back({double(i), t, a * std::pow(t, 2 * slope) + b, 1});
  }
  return points;
}

MeasuredRun run_of(const std::string& curve, double x, double cpu_s, double mse, const std::string& seed = "1") {
  MeasuredRun run;
  run.scene = "S";
  run.curve = run.label = curve;
  run.x = x;
  run.parameters["seed"] = seed;
  run.stages.emplace_back();
  run.stages[0].cpu_s = cpu_s;
  run.stages[0].wall_s = cpu_s / 2;
  run.error.emplace();
  run.error->mse = mse;
  return run;
}

TEST(CurveFitTest, MonteCarloCurveHasSlopeMinusOneHalfAndNoFloor) {
  const CurveFit fit = fit_curve(power_curve(6, 1e-4, -0.5, 0));
  EXPECT_NEAR(*fit.slope, -0.5, 1e-12);
  EXPECT_EQ(fit.slope_points, 6u);
  EXPECT_NEAR(fit.noise, 1e-4, 1e-12);
  EXPECT_FALSE(fit.floor);
}

TEST(CurveFitTest, FloorIsFoundAndItsPointsLeftOutOfTheSlope) {
  const auto points = power_curve(8, 1e-4, -0.5, 1e-6);  // a/t = 10 b at t = 10: points .1 .4 1.6 6.4 are before
  const CurveFit fit = fit_curve(points);
  ASSERT_TRUE(fit.floor);
  EXPECT_NEAR(*fit.floor, 1e-3, 1e-9);
  EXPECT_NEAR(fit.noise, 1e-4, 1e-10);
  EXPECT_EQ(fit.slope_points, 4u);
  EXPECT_LT(*fit.slope, -0.47);  // bends by less than 10 % in e^2; all eight points together give -0.37
  EXPECT_GT(*fit.slope, -0.5);
}

// Each e^2 off by 5 % at random, as from about 800 blocks. The slope over 8 points a factor 4 apart has
// standard deviation 0.025 / (ln 4 sqrt(42)) = 0.0028; sqrt(b), held by about three points, 0.05 / sqrt(3) /
// 2 = 1.5 %.
TEST(CurveFitTest, NoisyCurvesGiveSlopeAndFloorWithinTheirNoise) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    auto straight = power_curve(8, 1e-4, -0.5, 0), bent = power_curve(8, 1e-4, -0.5, 2e-6);
    for (std::size_t i = 0; i < 8; ++i) {
      const double u = unit_double(PathRandom(seed, i).bits(0, Purpose::test));
      const double factor = 1 + 0.05 * std::sqrt(3.0) * (2 * u - 1);
      straight[i].mse *= factor;
      bent[i].mse *= factor;
    }
    EXPECT_NEAR(*fit_curve(straight).slope, -0.5, 4 * 0.0028);
    const CurveFit fit = fit_curve(bent);
    ASSERT_TRUE(fit.floor);
    EXPECT_NEAR(*fit.floor, std::sqrt(2e-6), 4 * 0.015 * std::sqrt(2e-6));
  }
}

TEST(CurveFitTest, ASlowPowerLawIsNotTakenForAFloor) {
  const CurveFit fit = fit_curve(power_curve(7, 1e-4, -0.4, 0));
  EXPECT_FALSE(fit.floor);
  EXPECT_NEAR(*fit.slope, -0.4, 1e-12);
}

TEST(CurveFitTest, ACurveThatIsAllFloorHasNoSlopeToQuote) {
  const CurveFit fit = fit_curve(power_curve(5, 1e-9, -0.5, 1e-4));
  ASSERT_TRUE(fit.floor);
  EXPECT_NEAR(*fit.floor, 1e-2, 1e-5);
  EXPECT_FALSE(fit.slope);
}

TEST(CurveFitTest, TooFewPointsGiveNothing) {
  EXPECT_FALSE(fit_curve({}).slope);
  EXPECT_FALSE(fit_curve(power_curve(1, 1, -0.5, 0)).slope);
  EXPECT_FALSE(fit_curve({{1, 2.0, 1.0, 1}, {2, 2.0, 0.5, 1}}).slope);  // one time only
  EXPECT_NEAR(*fit_curve(power_curve(2, 1, -0.5, 0)).slope, -0.5, 1e-12);
}

TEST(TimeAtErrorTest, InterpolatesPowerLawsExactlyAndNeverExtrapolates) {
  const auto points = power_curve(5, 1e-4, -0.5, 0);  // e = 0.01 / sqrt(t), t = 0.1 .. 25.6
  EXPECT_NEAR(*time_at_error(points, 0.01), 1, 1e-12);
  EXPECT_NEAR(*time_at_error(points, 0.005), 4, 1e-12);
  EXPECT_NEAR(*time_at_error(points, 0.01 / std::sqrt(0.1)), 0.1, 1e-12);
  EXPECT_NEAR(*time_at_error(points, 0.01 / std::sqrt(25.6)), 25.6, 1e-9);
  EXPECT_FALSE(time_at_error(points, 0.0019));
  EXPECT_FALSE(time_at_error(points, 0.04));
}

TEST(TimeAtErrorTest, ANoisyCurveCountsFromWhereItFirstGetsThere) {
  const std::vector<CurvePoint> points{{1, 1, 1e-2, 1}, {2, 10, 1e-4, 1}, {3, 100, 1e-3, 1}, {4, 1000, 1e-5, 1}};
  EXPECT_NEAR(*time_at_error(points, std::sqrt(1e-3)), std::sqrt(10.0), 1e-9);
}

TEST(SpeedUpTest, IsTheRatioOfTimesInsideBothCurvesOnly) {
  const auto slow = power_curve(6, 1e-2, -0.5, 0), fast = power_curve(4, 1e-4, -0.5, 0);
  // slow: e = .32 .. .0099; fast: e = .032 .. .004. Shared .0316 .. .00988: 100 times faster everywhere.
  const auto found = speed_ups(fast, slow);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[0].rmse, 0.01 / std::sqrt(0.1), 1e-9);
  EXPECT_NEAR(found[2].rmse, 0.1 / std::sqrt(0.1 * 1024), 1e-9);
  for (const SpeedUp& speed_up : found) EXPECT_NEAR(speed_up.ratio(), 100, 1e-6);
  EXPECT_TRUE(speed_ups(power_curve(2, 1e-8, -0.5, 0), slow).empty());
  EXPECT_TRUE(speed_ups({}, slow).empty());
}

TEST(CurvesOfTest, RepetitionsBecomeOnePointOfMedianTimeAndMeanSquare) {
  const std::vector<MeasuredRun> runs{run_of("a", 10, 5, 1e-4, "1"), run_of("b", 10, 1, 1e-4),
                                      run_of("a", 10, 1, 3e-4, "2"), run_of("a", 10, 2, 2e-4, "3"),
                                      run_of("a", 5, 0.5, 1e-3)};
  const auto curves = curves_of(runs);
  ASSERT_EQ(curves.size(), 2u);
  ASSERT_EQ(curves[0].points.size(), 2u);
  EXPECT_EQ(curves[0].points[0].x, 5);
  EXPECT_EQ(curves[0].points[1].time_s, 2);
  EXPECT_NEAR(curves[0].points[1].mse, 2e-4, 1e-18);
  EXPECT_EQ(curves[0].points[1].repetitions, 3u);
}

TEST(CurvesOfTest, ErrorsTheReferenceDoesNotResolveAreLeftOutAndCounted) {
  std::vector<MeasuredRun> runs{run_of("a", 1, 1, 1e-4), run_of("a", 2, 2, -1e-9), run_of("a", 3, 3, 1e-6)};
  runs[2].error->mse_standard_error = 0.5e-6;
  runs.push_back(run_of("a", 4, 4, 1e-6));
  runs[3].error.reset();
  const auto curves = curves_of(runs);
  EXPECT_EQ(curves[0].points.size(), 1u);
  EXPECT_EQ(curves[0].left_out, 3u);
}

}  // namespace
}  // namespace tempolux
