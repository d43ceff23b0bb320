// tools/stages/count_photons.h -- counts the photons of a frame by elements of its surfaces.
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
  bool for_windows = false;  ///< use the same elements in all frames of a segment
  int frames = 33;           ///< frames in a full window
};
/// The options --photons, --kinds and --cell.
void add_count_options(Tool& tool, CountOptions& options);

struct CountedPhotons {
  formats::MeshirradFile file;  ///< its header is complete except for the filter and the history, which is the map's
  MeshOptions mesh;             ///< the widths
};
/// Counts the photons of a frame over all its elements; for windows, over the sides that photons reach. Adds their
/// number to stats.
CountedPhotons count_photons(Tool& tool, SceneInput& input, const CountOptions& options, const Tracer& tracer);

/// Writes a file and adds its number of elements to stats.
void write_mesh(Tool& tool, const formats::MeshirradFile& file, Output& output);

}  // namespace tempolux::tools
