// tools/stages/build_records.h -- irradcache-build: gathers records for the cameras of frames, or updates them for one
// state of light.
#pragma once

#include <vector>

#include "tools/stages/build_points.h"

namespace tempolux::tools {

/// Writes the records for the cameras of all frames as one cache, which is valid as long as only the camera changes.
/// If options.map is "static", the records are those of the static scene.
void build_records(Tool& tool, SceneInput& input, CacheOptions options, const std::vector<int>& frames);
/// Writes localised records: the static records, updated, and new records where movers change the light that the
/// cameras of `frames` see. The frames must have the same light.
void build_updated_records(Tool& tool, SceneInput& input, const CacheOptions& options, const std::vector<int>& frames,
                           StaticTree& tree);

}  // namespace tempolux::tools
