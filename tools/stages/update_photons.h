// tools/stages/update_photons.h -- photon-trace --update and --refine: makes a map from an earlier one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lib/photon/photon_update.h"
#include "lib/scene/at_frame.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

struct UpdateArguments {
  std::string update;  ///< file or pattern; "": no earlier map
  std::string share, pilots = "0%", strategy = "oldest";
  std::uint64_t refine = 0;  ///< further paths
  UpdateOptions how;
  bool updates() const { return !update.empty(); }
};

void add_update_options(Tool& tool, UpdateArguments& arguments);
/// Refuses options that contradict each other, and sets `how`. `static_or_dynamic`: true if --map is "static" or
/// "dynamic".
void check_update_arguments(const Tool& tool, bool static_or_dynamic, UpdateArguments& arguments);

/// Sets the number of pilots per group of the new map: --pilots, or that of the earlier map. --refine also takes the
/// number of groups from the earlier map, because --photons does not say how many paths that map has.
void set_groups(const UpdateArguments& arguments, int frame, PhotonOptions& photons);

/// Inputs of a new map.
struct MapToUpdate {
  const SceneFrame& frame;
  const PhotonTracer& photons;
  const formats::PhotonHeader& header;  ///< the header that the map would have if it were traced whole
  std::string output;                   ///< name of the new file
};
/// The previous map, kept in memory for the next frame of a range if it takes at most a quarter of the memory
/// (--max-memory, or the machine's).
struct KeptMap {
  bool wanted = false;  ///< true if there is a next frame
  std::string name;     ///< of the map's file; "": no map is kept
  PreviousMap map;
};

/// Writes the map of the frame through `sink`, by --update or --refine. Adds the numbers of groups and pilots to stats.
/// `kept`: the previous map, if it is in memory; becomes the new map if the new map is kept for the next frame.
PhotonMapResult update_map(Tool& tool, const UpdateArguments& arguments, const MapToUpdate& map,
                           const std::function<void(const void*, std::size_t)>& sink, KeptMap& kept);

}  // namespace tempolux::tools
