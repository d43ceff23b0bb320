// tools/stages/update_photons.h -- photon-trace --update and --refine: a map made from an earlier one.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "lib/photon/photon_update.h"
#include "lib/scene/at_frame.h"
#include "tools/common/tool_main.h"

namespace tempolux::tools {

struct UpdateArguments {
  std::string update;  ///< file or pattern; "": trace anew
  std::string share, pilots = "0%", strategy = "oldest";
  std::uint64_t max_groups = 0;
  std::string refine = "0";
  bool corrective = false;
  UpdateOptions how;
  bool updates() const { return !update.empty(); }
};

void add_update_options(CLI::App& app, UpdateArguments& arguments);
/// Refuses what does not fit together; sets `how`. `static_or_dynamic`: --map is not global.
void check_update_arguments(const Tool& tool, bool static_or_dynamic, UpdateArguments& arguments);

/// Pilots of each group in the map to come: of an update those of the map before.
std::uint32_t pilots_of(const UpdateArguments& arguments, const PhotonOptions& photons, int frame);

/// What a new map is made from.
struct MapToUpdate {
  const SceneFrame& frame;
  const PhotonTracer& photons;
  const PhotonOptions& options;
  const formats::PhotonHeader& header;  ///< of a map made anew
  std::string output;                   ///< name of the file to come
  std::function<std::shared_ptr<const PhotonTracer>(int frame)>
      tracer_at;  ///< the same through the smoke of another frame
};
/// Of a range: the map before stays in memory for the next frame, if it takes at most a quarter of it (--max-memory, or
/// the machine's).
struct KeptMap {
  bool wanted = false;  ///< there is a next frame
  std::string name;     ///< of the map's file; "": none is kept
  PreviousMap map;
};

/// Writes the map of the frame through `sink`, as --update, --refine and --corrective ask. Counts groups and pilots for
/// --stats. `kept`: the map before, if it is there; becomes the new one, if that can be kept.
PhotonMapResult update_map(Tool& tool, const UpdateArguments& arguments, const MapToUpdate& map,
                           const std::function<void(const void*, std::size_t)>& sink, KeptMap& kept);

}  // namespace tempolux::tools
