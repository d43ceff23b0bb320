// tools/stages/filter_frames.h -- st-filter: filters frames, alone or with their neighbours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "tools/common/output.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

struct FilterFramesOptions {
  std::vector<std::string> frames, flow;  ///< files in the order of time; with `range` one pattern each
  std::vector<std::string> channels;      ///< groups that the output has; empty: all of the frame
  std::string output, range;              ///< range: frames to filter; "": one of the files
  int position = 0;                       ///< number of the filtered file, from 1; 0: the middle one
};

/// Filters one of the files, or each frame of the range with the two before and after it. Throws InputError for names
/// that do not fit together.
void filter_frames(Tool& tool, const FilterFramesOptions& options);

/// Writes a frame that st-filter has made, with its history, and counts it. Begins and ends the phase "write".
/// `number`: of the frame; empty: not known.
void write_filtered(Tool& tool, Output& output, Image& image, std::optional<int> number);

}  // namespace tempolux::tools
