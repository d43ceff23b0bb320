// lib/plan/estimate.h -- what a run will cost.
#pragma once

#include <string>
#include <vector>

namespace tempolux {

/// One stage of the pipeline in the whole run.
struct StageEstimate {
  std::string stage;
  double runs = 0;   ///< processes
  double cpu_s = 0;  ///< of each
  double bytes = 0;  ///< of the files that each writes
};

/// The value at x of the power law through (x1, y1) and (x2, y2), 0 < x1 < x2, with an exponent of 0 to 2 in x:
/// how work grows with the width of the picture. 0 if y2 is 0; y2 (x/x2) if y1 is 0.
double power_law(double x1, double y1, double x2, double y2, double x);

/// A table for people, a line for each stage and one for all: CPU seconds and bytes; and the time on so many
/// processors, all of them busy.
std::string estimate_text(const std::vector<StageEstimate>& stages, int processors);

}  // namespace tempolux
