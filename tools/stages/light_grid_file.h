// tools/stages/light_grid_file.h -- .lightgrid files: what frame-render learned of light from far away.
#pragma once

#include <memory>
#include <string>

#include "lib/light/light_grid.h"
#include "tools/common/output.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Writes what was learned in `frame`; nullptr: no cells.
void write_light_grid(Tool& tool, const LightGrid* grid, const SceneFrame& frame, Output& output);

/// Reads a grid for `frame`; nullptr if it has no cells. One of another scene costs noise only, so it is taken as it
/// is; InputError if its lattice is not that of the frame's space, or it has other parts of the sky than LightGrid.
std::unique_ptr<LightGrid> read_light_grid(Tool& tool, const std::string& file, const SceneFrame& frame);

}  // namespace tempolux::tools
