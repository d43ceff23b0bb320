// tools/stages/vision_options.h -- aqm-compare's options of viewer and display.
#pragma once

#include <optional>
#include <string>

#include "lib/aqm/animation_quality.h"
#include "tools/common/tool_main.h"
#include "tools/stages/compare_inputs.h"

namespace tempolux::tools {

/// Values of the options.
struct VisionWords {
  std::string flow, map, display = "office", eye = "track";
  std::optional<double> exposure_stops;     ///< empty: that of the first frame
  std::optional<double> frames_per_second;  ///< empty: that of the flow or of the frame, else 24

  /// True if an option is given that needs the vision model.
  bool used() const { return !flow.empty() || !map.empty(); }
};

void declare_vision(Tool& tool, VisionWords& words);
/// The options for a sequence whose first frame is `first`, which gives the exposure and the frame rate that the words
/// leave open.
VisionOptions vision_options(const VisionWords& words, const LoadedFrame& first);

/// Writes a frame's map: EXR, or PNG with the map over the frame.
void write_map(const JudgedFrame& judged, const LoadedFrame& frame, const VisionOptions& options,
               const std::string& history, Output output);

}  // namespace tempolux::tools
