// lib/plan/estimate.h -- estimates the cost of a run.
#pragma once

#include <string>
#include <vector>

namespace tempolux {

/// One stage of the pipeline, over the whole run.
struct StageEstimate {
  std::string stage;
  double runs = 0;   ///< processes
  double cpu_s = 0;  ///< of each
  double bytes = 0;  ///< of each file that it writes
};

/// y2 (x / x2)^k: the power law through (x1, y1) and (x2, y2), 0 < x1 < x2, at x. It extrapolates work y measured at
/// picture widths x. The exponent k is clamped to [0, 2]; it is 1 if y1 is 0. Returns 0 if y2 is 0.
double power_law(double x1, double y1, double x2, double y2, double x);

/// A table for people: a line for each stage and one for the sum, with CPU seconds and bytes, and the wall time on
/// `processors` busy processors.
std::string estimate_text(const std::vector<StageEstimate>& stages, int processors);

}  // namespace tempolux
