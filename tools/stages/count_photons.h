// tools/stages/count_photons.h -- counts the photons of a frame by elements of its surfaces.
#pragma once

#include <string>
#include <vector>

#include "lib/light_texture/mesh_elements.h"
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
/// Cuts the frame's surfaces into elements and counts in each the photons that arrived there. The result holds all
/// elements of the frame; with for_windows only the sides of elements at which photons arrived. Adds the numbers of
/// photons and of photons without a surface to the statistics. Throws InputError for a map of another scene, of a part
/// of the light, or without a wanted kind.
CountedPhotons count_photons(Tool& tool, SceneInput& input, const CountOptions& options, const Tracer& tracer);

/// Writes a file and adds its number of elements to stats.
void write_mesh(Tool& tool, const formats::MeshirradFile& file, Output& output);

}  // namespace tempolux::tools
