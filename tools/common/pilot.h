// tools/common/pilot.h -- scene-plan --estimate: short runs of the other tools, from which the whole run is estimated.
#pragma once

#include <functional>
#include <string>

#include "lib/plan/estimate.h"
#include "lib/plan/plan.h"
#include "lib/render/choose_moving.h"

namespace tempolux::tools {

/// How the stages will be run: options as on their command lines, without scene, inputs, frame and output.
struct RunOptions {
  std::string photons, points, cache, frames;
  MovingCost moving_cost;                 ///< of a state of light; 1 where all is computed anew
  int width = 640, height = 360;
  int threads = 1;
  std::function<void(double)> progress;  ///< called with [0, 1]; may be empty
};

/// Path of the folder that estimate_run of a process on this host works in, but for the process's number.
std::string short_run_stem();

/// Runs the programs beside this one on a fraction of the photons and pixels, for the first picture of the plan, in
/// a folder of its own that is removed again, by a signal too. Takes a few hundredths of the time of one frame.
/// ResourceError if one of them fails; what it said stands on standard error.
Estimate estimate_run(const std::string& scene, const Plan& plan, const RunOptions& options);

}  // namespace tempolux::tools
