// tools/stages/compare_frames.h -- aqm-compare: compares the frames of a run, and writes figures and difference images.
#pragma once

#include <string>
#include <vector>

#include "tools/stages/vision_options.h"

namespace tempolux::tools {

struct CompareOptions {
  std::string test, reference, layer, mask, except, relative_to, json, difference, metric = "error";
  VisionWords vision;
  std::vector<std::string> reference_halves;
  bool halves = false, either = false, allow_stale = false;
  double fail_above = -1;
  bool fails_by_aqm = false;  ///< true: fail_above is a share of pixels; false: an RMSE

  bool needs_vision() const { return either || metric == "aqm" || fails_by_aqm || vision.used(); }
  std::string layer_or_rgb() const { return layer == "RGB" ? "" : layer; }
  std::vector<std::string> references() const {
    return reference_halves.empty() ? std::vector{reference} : reference_halves;
  }
};

/// Compares all frames and writes the requested outputs. `frames_given`: the user names frames, which fill patterns.
/// Returns the exit code: exit_differs if the error is above fail_above. Throws InputError for options that contradict
/// each other, before any file is read.
int compare(Tool& tool, const CompareOptions& options, bool frames_given);

}  // namespace tempolux::tools
