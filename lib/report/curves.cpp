// lib/report/curves.cpp -- builds curves from runs and fits them.
#include "lib/report/curves.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "lib/core/statistics.h"

namespace tempolux {
namespace {

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// The runs of one setting, which differ only in their seeds.
struct Setting {
  std::optional<double> x;
  std::vector<double> times, squares;
  std::vector<std::optional<double>> standard_errors;

  /// True if the mean error of the repetitions is positive and above three of its standard errors, if these are known.
  bool usable() const {
    double sum = 0, variance = 0;
    bool known = true;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      sum += squares[i];
      known = known && standard_errors[i];
      if (known) variance += *standard_errors[i] * *standard_errors[i];
    }
    return sum > 0 && median(times) > 0 && (!known || kCertain * std::sqrt(variance) < sum);
  }
  CurvePoint point() const {
    double sum = 0;
    for (const double square : squares) sum += square;
    return {x, median(times), sum / double(squares.size()), squares.size()};
  }
};

/// log e = intercept + slope log t.
struct Line {
  double slope = 0, intercept = 0;
  std::optional<double> slope_standard_error;
};

/// Least-squares line through (log t, log e).
std::optional<Line> log_log_line(const std::vector<CurvePoint>& points) {
  const double n = double(points.size());
  double mean_t = 0, mean_e = 0;
  for (const CurvePoint& p : points) {
    mean_t += std::log(p.time_s) / n;
    mean_e += 0.5 * std::log(p.mse) / n;
  }
  double tt = 0, te = 0;
  for (const CurvePoint& p : points) {
    const double t = std::log(p.time_s) - mean_t;
    tt += t * t;
    te += t * (0.5 * std::log(p.mse) - mean_e);
  }
  if (points.size() < 2 || tt <= 1e-12) return std::nullopt;  // Points at one time have no slope.
  Line line{te / tt, mean_e - te / tt * mean_t, std::nullopt};
  double residuals = 0;
  for (const CurvePoint& p : points) {
    const double r = 0.5 * std::log(p.mse) - line.intercept - line.slope * std::log(p.time_s);
    residuals += r * r;
  }
  if (points.size() > 2) line.slope_standard_error = std::sqrt(residuals / (n - 2) / tt);
  return line;
}

/// e^2 = a/t + b by least squares of relative deviations. The unknowns are a / t0 and b; a point's equation is
/// (t0 / t / e^2) a / t0 + (1 / e^2) b = 1.
struct FloorModel {
  double a = 0, b = 0, b_standard_error = 0, residuals = 0;
};

FloorModel fit_floor(const std::vector<CurvePoint>& points) {
  double uu = 0, uv = 0, vv = 0, u1 = 0, v1 = 0;
  const double t0 = points.front().time_s;
  for (const CurvePoint& p : points) {
    const double u = t0 / p.time_s / p.mse, v = 1 / p.mse;
    uu += u * u, uv += u * v, vv += v * v, u1 += u, v1 += v;
  }
  const double determinant = uu * vv - uv * uv;
  FloorModel model;
  double a = 0;
  if (determinant > 1e-12 * uu * vv) {
    a = (u1 * vv - v1 * uv) / determinant;
    model.b = (v1 * uu - u1 * uv) / determinant;
  }
  if (model.b <= 0) a = u1 / uu, model.b = 0;
  if (a <= 0) a = 0, model.b = v1 / vv;
  for (const CurvePoint& p : points) {
    const double deviation = (a * t0 / p.time_s + model.b) / p.mse - 1;
    model.residuals += deviation * deviation;
  }
  const double n = double(points.size());
  if (determinant > 1e-12 * uu * vv)
    model.b_standard_error = std::sqrt(model.residuals / std::max(n - 2, 1.0) * uu / determinant);
  model.a = a * t0;
  return model;
}

/// Sum of the squared relative deviations of e^2 from a power law, to compare with FloorModel::residuals.
double power_law_residuals(const std::vector<CurvePoint>& points, const Line& line) {
  double sum = 0;
  for (const CurvePoint& p : points) {
    const double deviation = std::exp(2 * (line.intercept + line.slope * std::log(p.time_s))) / p.mse - 1;
    sum += deviation * deviation;
  }
  return sum;
}

}  // namespace

std::vector<Curve> curves_of(const std::vector<MeasuredRun>& runs) {
  using Key = std::tuple<std::optional<double>, std::map<std::string, std::string>>;
  std::vector<Curve> curves;
  std::vector<std::map<Key, Setting>> settings;
  for (const MeasuredRun& run : runs) {
    std::size_t c = 0;
    while (c < curves.size() && (curves[c].scene != run.scene || curves[c].name != run.curve)) ++c;
    if (c == curves.size()) curves.push_back({run.scene, run.curve, {}, 0}), settings.emplace_back();
    if (!run.error) {
      ++curves[c].left_out;
      continue;
    }
    auto parameters = run.parameters;
    parameters.erase("seed");
    if (!run.x) parameters["label"] = run.label;
    Setting& setting = settings[c][{run.x, parameters}];
    setting.x = run.x;
    setting.times.push_back(run.cpu_s());
    setting.squares.push_back(run.error->mse);
    setting.standard_errors.push_back(run.error->mse_standard_error);
  }
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (const auto& [key, setting] : settings[c]) {
      if (setting.usable()) curves[c].points.push_back(setting.point());
      else curves[c].left_out += setting.squares.size();
    }
    std::ranges::stable_sort(curves[c].points, {}, &CurvePoint::time_s);
  }
  return curves;
}

CurveFit fit_curve(const std::vector<CurvePoint>& points) {
  CurveFit fit;
  const std::optional<Line> whole = log_log_line(points);
  if (!whole) return fit;
  std::vector<CurvePoint> before = points;
  if (points.size() >= 3) {
    const FloorModel model = fit_floor(points);
    fit.noise = model.a;
    fit.floor_squared = model.b;
    const double least = std::ranges::min(points, {}, &CurvePoint::mse).mse;
    if (model.b > 2 * model.b_standard_error && model.b > 0.01 * least &&
        model.residuals < power_law_residuals(points, *whole)) {
      fit.floor = std::sqrt(model.b);
      std::erase_if(before, [&](const CurvePoint& p) { return p.mse <= 10 * model.b; });
    }
  }
  if (const std::optional<Line> line = log_log_line(before)) {
    fit.slope = line->slope;
    fit.slope_standard_error = line->slope_standard_error;
    fit.slope_points = before.size();
  }
  return fit;
}

std::optional<double> time_at_error(const std::vector<CurvePoint>& points, double rmse) {
  const double wanted = std::log(rmse);
  const auto error = [&](std::size_t i) { return 0.5 * std::log(points[i].mse); };
  constexpr double kEqual = 1e-9;  // relative rounding by root and square
  if (points.empty() || error(0) < wanted - kEqual) return std::nullopt;
  if (error(0) <= wanted + kEqual) return points[0].time_s;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (error(i) > wanted + kEqual) continue;
    const double part = std::clamp((error(i - 1) - wanted) / (error(i - 1) - error(i)), 0.0, 1.0);
    return std::exp(std::lerp(std::log(points[i - 1].time_s), std::log(points[i].time_s), part));
  }
  return std::nullopt;
}

std::vector<SpeedUp> speed_ups(const std::vector<CurvePoint>& points, const std::vector<CurvePoint>& baseline) {
  if (points.empty() || baseline.empty()) return {};
  const auto least = [](const std::vector<CurvePoint>& p) {
    return std::sqrt(std::ranges::min(p, {}, &CurvePoint::mse).mse);
  };
  const double high = std::sqrt(std::min(points.front().mse, baseline.front().mse));
  const double low = std::max(least(points), least(baseline));
  if (low > high) return {};
  std::vector<double> errors{high, std::sqrt(high * low), low};
  if (high - low <= 1e-9 * high) errors = {high};
  std::vector<SpeedUp> found;
  for (const double rmse : errors) {
    const auto time = time_at_error(points, rmse), baseline_time = time_at_error(baseline, rmse);
    if (time && baseline_time) found.push_back({rmse, *time, *baseline_time});
  }
  return found;
}

}  // namespace tempolux
