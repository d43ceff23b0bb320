// tools/stages/influence_options.h -- options of localised gathering.
#pragma once

#include "lib/gather/localised.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// Adds --influence-low and --influence-high.
void influence_options(Tool& tool, InfluenceThresholds& thresholds);
/// Throws InputError unless 0 <= low < high.
void check_influence(const InfluenceThresholds& thresholds);

}  // namespace tempolux::tools
