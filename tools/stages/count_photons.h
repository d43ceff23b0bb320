// tools/stages/count_photons.h -- photons of a frame counted by elements of its surfaces: for st-filter mesh and gather-temporal density.
#pragma once

#include <string>
#include <vector>

#include "lib/gather/mesh_elements.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

struct CountOptions {
  std::string photons;                        ///< file, or a pattern
  std::vector<std::string> kinds{"indirect"};
  MeshOptions mesh;
  bool for_windows = false;                   ///< the same elements in all frames of a segment, as small as `frames` frames of photons ask for
  int frames = 33;
};
/// The options --photons, --kinds and --cell.
void add_count_options(CLI::App& app, CountOptions& options);

/// Counts the photons of a frame. The file has all elements of the frame; its header is complete but for filter and history, which is the map's. Counts
/// photons for stats. `mesh`: receives the widths.
formats::MeshirradFile count_photons(Tool& tool, SceneInput& input, const CountOptions& options, const SceneFrame& frame, StandingTree& standing,
                                     MeshOptions& mesh);

/// Writes a file and counts its elements for stats.
void write_mesh(Tool& tool, const formats::MeshirradFile& file, Output& output);

}  // namespace tempolux::tools
