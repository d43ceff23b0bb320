// tools/stages/gather_frames.h -- gather-temporal final: records that keep their incoming light from frame to frame.
#pragma once

#include <string>
#include <vector>

#include "lib/gather/final_gather.h"
#include "lib/gather/place_records.h"
#include "lib/temporal/temporal_gather.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

struct TemporalGatherOptions {
  std::vector<std::string> inputs;  ///< final SCENE
  std::string points, high, previous, output, cache;
  int width = 640, height = 360;
  GatherOptions gather;
  PlacementOptions placement;
  TemporalOptions temporal;

  const std::string& scene() const { return inputs.back(); }
};

/// Gathers the frames of the run. Each frame continues from the previous one; the first from options.previous, if
/// given.
void gather_frames(Tool& tool, SceneInput& input, const TemporalGatherOptions& options);

}  // namespace tempolux::tools
