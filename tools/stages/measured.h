// tools/stages/measured.h -- photons of a preview by what `make measure` has measured (formats/plan/plan.md).
#pragma once

#include <map>
#include <string>

#include "lib/plan/decisions.h"

namespace tempolux::tools {

/// The photons for each segment of the table, by the segment's first frame: the fewest photons with which a viewer
/// sees errors in at most `share` of the pixels. If no tried number reaches this, the number with the least share.
/// Throws InputError naming the place.
std::map<int, Measured> measured_photons(const std::string& path, double share);

}  // namespace tempolux::tools
