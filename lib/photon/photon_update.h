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
  std::uint64_t most_groups = 0;  ///< limit of groups traced again
  /// The priority of a group, by census or pilots, is multiplied by age^age_power. age: number of frames since the
  /// group was traced. 0 is the papers' rule, under which some groups may never be traced again.
  double age_power = 1;
};

/// The reason why the map cannot be updated to `header` (the new map's) with these options; "" if it can: groups,
/// paths, kinds, columns, majorants, emission table and origin must be equal.
std::string why_not_updatable(const formats::PhotonHeader& previous, const formats::PhotonHeader& header);

/// The groups to trace again at `frame`, ascending. If `same` (nothing that light depends on has changed) no group is
/// chosen, except by the strategy `all`. Ties are broken by a hash of frame and group, so that no group is favoured.
std::vector<std::uint32_t> choose_groups(const PreviousMap& previous, int frame, bool same,
                                         const UpdateOptions& options);

/// An update of a map.
struct MapUpdate {
  std::string path;  ///< of the earlier map
  PreviousMap&
      previous;  ///< a map kept in memory, which becomes the new map if that is an overlay; otherwise it is released
  std::span<const std::uint32_t> groups;  ///< to be traced again, ascending
  bool may_overlay = false;               ///< true if the new map lies in the same folder
};

/// Writes the map of `header` through `sink`: the chosen groups are traced, all others copied from the earlier map. If
/// at most half of the groups differ from the base the map is written as an overlay on it, otherwise whole.
PhotonMapResult write_updated_map(const PhotonTracer& tracer, formats::PhotonHeader header, const MapUpdate& update,
                                  const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
