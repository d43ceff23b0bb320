// lib/photon/photon_update.h -- selective photon tracing: traces some groups of an earlier map again and keeps the
// others.
//
// Papers: Dmitriev et al. 2002; Jimenez, Myszkowski, Pueyo 2005. Method: docs/methods/volume_photons.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/photon/photon_map.h"
#include "lib/photon/previous_map.h"

namespace tempolux {

struct UpdateOptions {
  UpdateStrategy strategy = UpdateStrategy::oldest;
  std::uint64_t most_groups = 0;  ///< largest number of groups that are traced again
  /// The priority of a group by census or pilots is multiplied by age^age_power, where age is the number of frames
  /// since the group was traced. 0 is the papers' rule, under which some groups may never be traced again.
  double age_power = 1;
};

/// The reason why a map cannot be updated, as a clause for a message; "" if it can be. `header` is the header of the
/// new map. Groups, paths, kinds, columns, pilots, majorants, emission table and origin of the two must be equal.
std::string why_not_updatable(const formats::PhotonHeader& previous, const formats::PhotonHeader& header);

/// The groups to trace again at `frame`, ascending. `same`: nothing that light depends on has changed; then only the
/// strategy `all` chooses groups. Groups of equal priority are ordered by a hash of frame and group, so that no group
/// is preferred in all frames.
std::vector<std::uint32_t> choose_groups(const PreviousMap& previous, int frame, bool same,
                                         const UpdateOptions& options);

/// An update of a map.
struct MapUpdate {
  std::string path;  ///< file of the earlier map
  /// The earlier map. If it is kept in memory and the new map is an overlay, it becomes the new map; if the new map is
  /// whole, its photons are released.
  PreviousMap& previous;
  std::span<const std::uint32_t> groups;  ///< to be traced again, ascending
  bool may_overlay = false;               ///< true if the new map lies in the folder of the earlier map
};

/// Writes the map of `header` through `sink`. Traces the chosen groups and copies all others from the earlier map. If
/// at most half of the groups differ from a base, the new map is written as an overlay; otherwise it is written whole.
/// The base is the base of the earlier map, or the earlier map itself if it is whole.
PhotonMapResult write_updated_map(const PhotonTracer& tracer, formats::PhotonHeader header, const MapUpdate& update,
                                  const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
