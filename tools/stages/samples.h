// tools/stages/samples.h -- make estimate: small plans that make runs, from whose statistics the whole run is
// estimated.
#pragma once

#include <string>

#include "lib/plan/estimate.h"
#include "tools/stages/planning.h"

namespace tempolux::tools {

/// Writes two plans into the folder, small.mk and large.mk, which make the first picture of the plan, and the first
/// that is warped, 64 and 128 pixels wide, with fewer photons, gather rays and cameras that share records; and
/// samples.json: their files, and how often each stage runs in the plan itself.
void write_samples(const std::string& folder, Planner& planner, const Wish& wish);

/// What the plan will cost, from the samples after make has made them: of each stage its mean file in both. Start and
/// scene are the same in the whole run; work and bytes go on by the power law of the width of the picture that the two
/// samples show, times photons, rays and cameras. InputError if the folder does not hold that.
std::vector<StageEstimate> estimate_from(const std::string& folder);

}  // namespace tempolux::tools
