// tools/stages/samples.h -- `make estimate`: two small plans that make runs; their statistics give the cost of the
// whole run.
#pragma once

#include <string>

#include "lib/plan/estimate.h"
#include "tools/stages/planning.h"

namespace tempolux::tools {

/// Writes two plans into the folder, small.mk and large.mk, 64 and 128 pixels wide, with fewer photons, gather rays and
/// cameras that share records. They make the first picture of the plan and the first warped picture. samples.json lists
/// their files, and how often each stage runs in the full plan.
void write_samples(const std::string& folder, Planner& planner, const Wish& wish);

/// Estimates the cost of the full plan. make must have made both plans of write_samples() before. A stage's CPU time
/// has a fixed part (start, loading the scene) and the work of its phases (StageInfo::work). Work and bytes per command
/// are extrapolated to the full picture width by a power law through the means of the two sizes, and multiplied by the
/// ratios of photons, rays and cameras. costs.json gets CPU time and memory of a command of each stage, which a plan in
/// whose state/ it lies takes for its own (PlanFolder::costs). A stage without statistics is left out.
/// The file planned.json holds the statistics of scene-plan. The file `made` holds the CPU seconds [s] of all processes
/// that made the two samples. Throws InputError if the folder does not hold the samples.
std::vector<StageEstimate> estimate_from(const std::string& folder);

}  // namespace tempolux::tools
