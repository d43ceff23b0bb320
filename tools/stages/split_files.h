// tools/stages/split_files.h -- photonmap-split: divides a file of photons or irradiance points in two.
#pragma once

#include <optional>
#include <string>

#include "lib/density/split_light.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

struct SplitOptions {
  std::string input, low, high;
  std::optional<double> cell;    ///< edge, m; empty: automatic
  double spacings_per_cell = 4;  ///< edge of an automatic cell of points, in mean distances of points
  double limit = kBrightLimit;   ///< a cell keeps at most this multiple of the mean irradiance in the low part
};

/// Reads the input, whose first bytes determine its type, and writes the low and the high part. Throws InputError for
/// a file of another type, or for a file that is a part already.
void split_file(Tool& tool, const SplitOptions& options);

}  // namespace tempolux::tools
