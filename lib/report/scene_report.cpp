// lib/report/scene_report.cpp -- builds the tables of a scene and the names of its files.
#include "lib/report/scene_report.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "lib/report/text.h"

namespace tempolux {
namespace {

std::optional<double> percent(std::optional<double> value) {
  return value ? std::optional(100 * *value) : std::nullopt;
}

std::string worst_text(const WorstObject& worst) {
  return number_text(100 * worst.bias, "%.2f") + " (" +
         (worst.name.empty() ? "id " + std::to_string(worst.id) : worst.name) + ")";
}

Table runs_table(const ReportInput& input, const std::string& scene) {
  Table table{"Runs",
              {"curve", "run", "x", "CPU s", "wall s", "peak MB", "RMSE", "relMSE", "bias %", "+-", "worst object %",
               "flicker"},
              {},
              ""};
  bool noisy = false, unresolved = false;
  for (const MeasuredRun& run : input.runs) {
    if (run.scene != scene) continue;
    const ErrorRecord none, &error = run.error ? *run.error : none;
    noisy = noisy || (run.error && !error.halves);
    unresolved = unresolved || (run.error && !error.usable());
    const std::string rmse = !run.error ? "" : error.usable() ? number_text(error.rmse()) : "not resolved";
    const std::string worst = error.worst_object ? worst_text(*error.worst_object) : "";
    table.rows.push_back({run.curve, run.label, number_text(run.x, "%g"), number_text(run.cpu_s(), "%.3g"),
                          number_text(run.wall_s(), "%.3g"), number_text(run.peak_memory_bytes() / 1e6, "%.0f"), rmse,
                          number_text(error.relmse), number_text(percent(error.bias), "%.3f"),
                          number_text(percent(error.bias_standard_error), "%.3f"), worst, number_text(error.flicker)});
  }
  if (noisy) table.note = "Some runs were compared with one reference: its noise is part of their RMSE.";
  if (unresolved)
    table.note +=
        std::string(table.note.empty() ? "" : " ") +
        "Not resolved: the error is below the reference's noise; more samples of the reference show it (make: "
        "REFERENCE_SAMPLES=256).";
  return table;
}

Table fits_table(const SceneReport& report) {
  Table table{"Error against CPU s",
              {"curve", "points", "runs left out", "slope", "+-", "from points", "bias floor"},
              {},
              "Slope of log RMSE over log time, over the points before the floor; floor of the fit RMSE^2 = "
              "a/t + b."};
  for (std::size_t i = 0; i < report.curves.size(); ++i) {
    const Curve& curve = report.curves[i];
    const CurveFit& fit = report.fits[i];
    const std::string floor = fit.floor ? number_text(fit.floor) : curve.points.size() < 3 ? "" : "none seen";
    table.rows.push_back({curve.name, std::to_string(curve.points.size()), std::to_string(curve.left_out),
                          number_text(fit.slope, "%.3f"), number_text(fit.slope_standard_error, "%.3f"),
                          std::to_string(fit.slope_points), floor});
  }
  return table;
}

Table speed_up_table(const SceneReport& report, const std::string& baseline) {
  Table table{"Equal-error speed-up",
              {"curve", "over", "RMSE", "CPU s", "baseline CPU s", "ratio"},
              {},
              "Inside both curves only, between neighbouring points; nothing is extrapolated."};
  const auto base = std::ranges::find(report.curves, baseline, &Curve::name);
  if (base == report.curves.end()) return table;
  for (const Curve& curve : report.curves)
    if (&curve != &*base)
      for (const SpeedUp& found : speed_ups(curve.points, base->points))
        table.rows.push_back({curve.name, base->name, number_text(found.rmse), number_text(found.time_s, "%.3g"),
                              number_text(found.baseline_time_s, "%.3g"), number_text(found.ratio(), "%.2f")});
  return table;
}

Table points_table(const SceneReport& report) {
  Table table{"Given points, not measured here", {"point", "CPU s", "RMSE"}, {}, ""};
  for (const Curve& curve : report.curves) table.header.push_back(curve.name + ": times faster");
  table.header.push_back("note");
  for (const GivenPoint& point : report.points) {
    std::vector<std::string> row{point.label, number_text(point.cpu_s), number_text(point.rmse)};
    for (const Curve& curve : report.curves) {
      const auto time = time_at_error(curve.points, point.rmse);
      row.push_back(time ? number_text(point.cpu_s / *time, "%.2f") : "");
    }
    row.push_back(point.note);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string stem_of(const std::string& scene, std::set<std::string>& taken) {
  std::string stem = "error-";
  for (const char c : scene) stem += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '_';
  std::string unique = stem;
  for (int i = 2; !taken.insert(unique).second; ++i) unique = stem + "-" + std::to_string(i);
  return unique;
}

}  // namespace

std::vector<SceneReport> scene_reports(const ReportInput& input) {
  std::vector<SceneReport> reports;
  std::set<std::string> taken;
  const auto report_of = [&](const std::string& scene) -> SceneReport& {
    const auto found = std::ranges::find(reports, scene, &SceneReport::scene);
    if (found != reports.end()) return *found;
    SceneReport& report = reports.emplace_back();
    report.scene = scene;
    report.file_stem = stem_of(scene, taken);
    return report;
  };
  for (Curve& curve : curves_of(input.runs)) {
    SceneReport& report = report_of(curve.scene);
    report.fits.push_back(fit_curve(curve.points));
    report.curves.push_back(std::move(curve));
  }
  for (const GivenPoint& point : input.points) report_of(point.scene).points.push_back(point);

  for (SceneReport& report : reports) {
    const std::string first = report.curves.empty() ? "" : report.curves.front().name;
    for (Table& table :
         std::vector{runs_table(input, report.scene), fits_table(report),
                     speed_up_table(report, input.baseline.empty() ? first : input.baseline), points_table(report)})
      if (!table.rows.empty()) report.tables.push_back(std::move(table));
  }
  return reports;
}

}  // namespace tempolux
