// lib/plan/estimate.h -- what a run will cost, from short runs of its stages on the same scene and machine.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tempolux {

/// What a short run of a tool cost: processor time and bytes, of which a part grows with the work.
struct PilotRun {
  double fixed_cpu_s = 0;  ///< start, reading the scene: the same for any amount of work
  double work_cpu_s = 0;   ///< in proportion to `work`
  double work = 1;         ///< paths, points, records, pixels; > 0
  double bytes = 0;        ///< written, in proportion to `work`
};

/// One stage of the pipeline in the whole run.
struct StageEstimate {
  std::string stage;
  double runs = 0;                ///< processes
  double fixed_cpu_s = 0;         ///< of each; one thread
  double work_cpu_s = 0;          ///< of each; all threads
  double bytes = 0;               ///< of the file each writes

  double cpu_s() const { return runs * (fixed_cpu_s + work_cpu_s); }
  double total_bytes() const { return runs * bytes; }
};

/// `runs` processes that each do `work` where the pilot did pilot.work.
StageEstimate scaled(const std::string& stage, double runs, const PilotRun& pilot, double work);

/// The value at x of the power law through (x1, y1) and (x2, y2), 0 < x1 < x2, with an exponent of 0 to 2 in x:
/// how the number of records grows with the width of the picture. 0 if y2 is 0; y2 (x/x2) if y1 is 0.
double power_law(double x1, double y1, double x2, double y2, double x);

/// Costs a and b >= 0 with a m1 + b n1 = t1 and a m2 + b n2 = t2, for two pilots of m and n pieces of two kinds of
/// work; where that has no such solution, a = 0 or b = 0 and the second pilot, the larger, decides.
struct TwoCosts {
  double a = 0, b = 0;
};
TwoCosts two_costs(double m1, double n1, double t1, double m2, double n2, double t2);

struct Estimate {
  std::vector<StageEstimate> stages;
  double cpu_s() const;
  double bytes() const;
  /// Stages one after the other; `jobs` processes at a time, of `threads` threads each, on `processors`. A fixed
  /// part keeps one processor busy. 0 jobs or threads count as 1.
  double wall_s(int processors, int jobs, int threads) const;
};

/// A table for people, a line for each stage.
std::string estimate_text(const Estimate& estimate, int processors, int jobs, int threads);
/// The same as JSON: formats/plan/plan.md, "estimate".
std::string estimate_json(const Estimate& estimate, int processors, int jobs, int threads);

}  // namespace tempolux
