// tools/stages/vision_options.h -- aqm-compare's options about who looks at which display.
#pragma once

#include <optional>
#include <string>

#include "lib/aqm/animation_quality.h"
#include "tools/common/tool_main.h"
#include "tools/stages/compare_inputs.h"

namespace tempolux::tools {

/// Values of the options; numbers below 0 were not given.
struct VisionWords {
  std::string flow, map, display = "office", exposure = "auto", eye = "track";
  double peak = -1, pixels_per_degree = -1, frames_per_second = -1;

  /// One of the options that need the model of vision is there.
  bool used() const { return !flow.empty() || !map.empty(); }
};

void declare_vision(Tool& tool, VisionWords& words);
/// Throws InputError about words that do not go together, before anything is read.
void check_vision(const VisionWords& words, bool several_frames);
/// What the words mean for a sequence whose first frame is `first`: it chooses the exposure and the frame
/// rate that were not given.
VisionOptions vision_options(const VisionWords& words, const LoadedFrame& first);

/// Writes a frame's map: EXR, or PNG with the map over the frame.
void write_map(Tool& tool, const JudgedFrame& judged, const LoadedFrame& frame, const VisionOptions& options,
               std::optional<int> number, Output output);

}  // namespace tempolux::tools
