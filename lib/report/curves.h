// lib/report/curves.h -- error against time: slope, bias floor, speed-up at equal error.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lib/report/report_input.h"

namespace tempolux {

/// One setting of a chain: the median time and the mean square error of its repetitions (seeds).
struct CurvePoint {
  std::optional<double> x;
  double time_s = 0;
  double mse = 0;
  std::size_t repetitions = 1;
};

/// The usable points of one curve of a scene, by ascending time. Runs with equal x and label are repetitions of one
/// point.
struct Curve {
  std::string scene, name;
  std::vector<CurvePoint> points;
  std::size_t left_out = 0;  ///< number of runs without a comparison, or with an error below the reference's noise
};

/// Curves in the order in which the runs name them first. A point with a time or error that is not positive is left
/// out.
std::vector<Curve> curves_of(const std::vector<MeasuredRun>& runs);

/// Slope and floor of a curve.
struct CurveFit {
  /// Least-squares slope of log error over log time; -1/2 for Monte Carlo. Only points with a squared error above ten
  /// times the floor's count: there a/t + b has a slope of -0.45 or steeper.
  std::optional<double> slope;
  std::optional<double> slope_standard_error;  ///< from the scatter around the line; needs three points
  std::size_t slope_points = 0;
  /// The fit e^2 = a/t + b by least squares of relative deviations; a and b are not negative. Needs three points.
  double noise = 0;          ///< a [error^2 s]
  double floor_squared = 0;  ///< b
  /// sqrt(b), if a floor is significant: b is above two of its standard errors and above 1 % of the smallest e^2, and
  /// the model fits better than a straight line in log-log. A missing floor does not prove that there is none.
  std::optional<double> floor;
};

/// Fits the points of a curve. A slope needs two points, a floor three.
CurveFit fit_curve(const std::vector<CurvePoint>& points);

/// Time at which a curve first reaches an error [in the unit of the root of its points], interpolated log-log between
/// neighbouring points. Empty if the curve starts below the error or never reaches it: times are never extrapolated.
std::optional<double> time_at_error(const std::vector<CurvePoint>& points, double rmse);

/// Equal-error speed-up of one curve over another at one error inside both.
struct SpeedUp {
  double rmse = 0, time_s = 0, baseline_time_s = 0;
  double ratio() const { return baseline_time_s / time_s; }
};

/// Speed-ups at both ends and at the geometric mean of the range of errors that both curves reach; empty if there is no
/// such range.
std::vector<SpeedUp> speed_ups(const std::vector<CurvePoint>& points, const std::vector<CurvePoint>& baseline);

}  // namespace tempolux
