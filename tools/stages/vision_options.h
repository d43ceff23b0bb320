// tools/stages/vision_options.h -- aqm-compare's options of viewer and display.
#pragma once

#include <optional>
#include <string>

#include "lib/aqm/animation_quality.h"
#include "tools/common/tool_main.h"
#include "tools/stages/compare_inputs.h"

namespace tempolux::tools {

/// Values of the options; numbers below 0 mean that the option is not given.
struct VisionWords {
  std::string flow, map, display = "office", exposure = "auto", eye = "track";
  double frames_per_second = -1;

  /// True if an option is given that needs the vision model.
  bool used() const { return !flow.empty() || !map.empty(); }
};

void declare_vision(Tool& tool, VisionWords& words);
/// Throws InputError for options that contradict each other, before any file is read.
void check_vision(const VisionWords& words, bool several_frames);
/// The options for a sequence whose first frame is `first`, from which exposure and frame rate are taken if not given.
VisionOptions vision_options(const VisionWords& words, const LoadedFrame& first);

/// Writes a frame's map: EXR, or PNG with the map over the frame.
void write_map(const JudgedFrame& judged, const LoadedFrame& frame, const VisionOptions& options,
               const std::string& history, Output output);

}  // namespace tempolux::tools
