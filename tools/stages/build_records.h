// tools/stages/build_records.h -- irradcache-build: records gathered for the cameras of frames, or updated for one
// state of light.
#pragma once

#include <vector>

#include "tools/stages/build_points.h"

namespace tempolux::tools {

/// Records for the cameras of all frames: one cache, valid while nothing but the camera changes. Of what stands if
/// options.map is "static".
void build_records(Tool& tool, SceneInput& input, CacheOptions options, const std::vector<int>& frames);
/// Records by localised gathering: those of what stands, updated, and new ones where movers matter to the cameras of
/// `frames`, which are lit alike.
void build_updated_records(Tool& tool, SceneInput& input, const CacheOptions& options, const std::vector<int>& frames,
                           StandingTree& tree);

}  // namespace tempolux::tools
