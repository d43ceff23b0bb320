// tools/stages/light_grid_file.h -- reads and writes .lightgrid files: learned visibility of distant light.
#pragma once

#include <memory>
#include <string>

#include "lib/light/light_grid.h"
#include "tools/common/output.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

/// Writes what was learned at `frame`; nullptr: a file without cells.
void write_light_grid(Tool& tool, const LightGrid* grid, const SceneFrame& frame, Output& output);

/// Reads a grid for `frame`; nullptr if it has no cells. A grid of another scene only causes noise, so it is accepted.
/// Throws InputError if its lattice does not fit the frame's space, or its parts of the sky are not LightGrid's.
std::unique_ptr<LightGrid> read_light_grid(Tool& tool, const std::string& file, const SceneFrame& frame);

}  // namespace tempolux::tools
