// tools/stages/count_photons.h -- photons of a frame counted by elements of its surfaces.
#pragma once

#include <string>
#include <vector>

#include "lib/gather/mesh_elements.h"
#include "tools/common/scene_input.h"

namespace tempolux::tools {

struct CountOptions {
  std::string photons;  ///< file, or a pattern
  std::vector<std::string> kinds{"indirect"};
  MeshOptions mesh;
  bool for_windows = false;  ///< the same elements in all frames of a segment
  int frames = 33;           ///< of a full window
};
/// The options --photons, --kinds and --cell.
void add_count_options(CLI::App& app, CountOptions& options);

struct CountedPhotons {
  formats::MeshirradFile file;  ///< its header is complete but for filter and history, which is the map's
  MeshOptions mesh;             ///< the widths
};
/// Counts the photons of a frame, of all its elements or, for windows, of the sides that photons reach. Counts photons
/// for stats.
CountedPhotons count_photons(Tool& tool, SceneInput& input, const CountOptions& options, const SceneFrame& frame,
                             StandingTree& standing);

/// Writes a file and counts its elements for stats.
void write_mesh(Tool& tool, const formats::MeshirradFile& file, Output& output);

}  // namespace tempolux::tools
