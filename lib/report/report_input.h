// lib/report/report_input.h -- reads the input of a report from JSON: measured runs and given points.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tempolux {

/// A stats file (formats/stats/stats.md): the cost of one program run.
struct StatsRecord {
  double cpu_s = 0, wall_s = 0;
  double peak_memory_bytes = 0;
};

/// The object with the largest bias.
struct WorstObject {
  std::uint32_t id = 0;
  std::string name;  ///< "": not known
  double bias = 0;   ///< relative
};

/// The totals of a comparison file (formats/comparison/comparison.md): the error of a result.
struct ErrorRecord {
  double mse = 0;  ///< may be negative
  std::optional<double> mse_standard_error;
  std::optional<double> relmse, bias, bias_standard_error, flicker;
  bool halves = false;                      ///< the reference's noise is not in mse
  std::optional<WorstObject> worst_object;  ///< without objects of few pixels

  /// Square root of mse; 0 if mse is not positive.
  double rmse() const;
  /// True if mse is positive, and above three of its standard errors if these are known: the run is then a point of a
  /// curve.
  bool usable() const;
};

/// One measured run of a chain of tools: a line of the report and a point of a curve.
struct MeasuredRun {
  std::string scene, curve, label;
  std::optional<double> x;  ///< the swept parameter
  std::map<std::string, std::string> parameters;
  std::vector<StatsRecord> stages;  ///< one for each process
  std::optional<ErrorRecord> error;

  double cpu_s() const;  ///< sum over the stages
  double wall_s() const;
  double peak_memory_bytes() const;  ///< of the process with the largest peak
};

/// A point that was measured elsewhere (by another renderer): drawn, never fitted.
struct GivenPoint {
  std::string scene, label, note;
  double cpu_s = 0, rmse = 0;
};

/// Everything that a report shows.
struct ReportInput {
  std::string title = "Error against time";
  std::string baseline;  ///< name of the curve that speed-ups refer to; empty: each scene's first
  std::vector<MeasuredRun> runs;
  std::vector<GivenPoint> points;
  std::vector<std::string> files;  ///< all files that were read
};

/// Reads one file. Throws InputError "FILE: PLACE: WHAT; REMEDY".
StatsRecord read_stats(const std::string& path);
ErrorRecord read_comparison(const std::string& path);

/// Reads a manifest (formats/report/report.md) and all files it names, relative to its folder. Throws
/// InputError.
ReportInput read_manifest(const std::string& path);

/// Adds a run from the command line. `what` is KEY=VALUE{,KEY=VALUE} with the keys scene, curve, label, x (other keys
/// are parameters); `stats` is FILE{+FILE}; `comparison` is a file. Throws InputError.
void add_run(ReportInput& input, const std::string& what, const std::string& stats, const std::string& comparison);

}  // namespace tempolux
