// tools/stages/influence_options.h -- options of localised gathering.
#pragma once

#include "lib/gather/localised.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

/// --influence-low, --influence-high, --influence-absolute.
void influence_options(Tool& tool, InfluenceThresholds& thresholds);
/// InputError unless 0 <= low < high.
void check_influence(const InfluenceThresholds& thresholds);

}  // namespace tempolux::tools
