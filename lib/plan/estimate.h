// lib/plan/estimate.h -- estimates the cost of a run.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lib/plan/stages.h"

namespace tempolux {

/// One stage of the pipeline, over the whole run.
struct StageEstimate {
  std::string stage;
  double runs = 0;       ///< processes
  double cpu_s = 0;      ///< of each
  double bytes = 0;      ///< of each file that it writes
  double shown = 0;      ///< number of files that are copied to frames/
  bool passing = false;  ///< files are removed when they have been read
};

/// The cost of one command of a stage.
struct StageCost {
  double cpu_s = 0, memory = 0;  ///< CPU seconds; bytes
};
using StageCosts = std::map<std::string, StageCost, std::less<>>;  ///< by StageInfo::folder

/// The costs in the table of stages (kStages), for pictures of this size. They are shown until costs are measured.
StageCosts table_costs(int width, int height);

/// y2 (x / x2)^k: the power law through (x1, y1) and (x2, y2), 0 < x1 < x2, at x. It extrapolates work y measured at
/// picture widths x. The exponent k is clamped to [0, 2]; it is 1 if y1 is 0. Returns 0 if y2 is 0.
double power_law(double x1, double y1, double x2, double y2, double x);

/// A table for people: a line for each stage and one for the sum, with CPU seconds and bytes, and the wall time on
/// `processors` busy processors. The most bytes on the disk are those of the files, of the frames, which are copies,
/// and of two passing files for each processor: one is written, the other one waits.
std::string estimate_text(const std::vector<StageEstimate>& stages, int processors);

}  // namespace tempolux
