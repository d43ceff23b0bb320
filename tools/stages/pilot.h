// tools/stages/pilot.h -- scene-plan --estimate: short runs of the other tools, from which the whole run is estimated.
#pragma once

#include <string>

#include "lib/plan/estimate.h"
#include "tools/stages/planning.h"

namespace tempolux::tools {

/// Path of the folder that estimate_run of a process on this host works in, but for the process's number.
std::string short_run_stem();

/// Runs the programs beside this one on a fraction of the photons and pixels, for the first picture of the plan, in a folder
/// of its own that is removed again, by a signal too. Takes a few hundredths of the time of one frame. ResourceError if one of
/// them fails; what it said stands on standard error.
Estimate estimate_run(const std::string& scene, const Planned& planned, const Wish& wish, Tool& tool);

}  // namespace tempolux::tools
