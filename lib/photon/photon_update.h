// lib/photon/photon_update.h -- selective photon tracing: of an earlier map some groups are shot again, the others
// kept.
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
  std::uint64_t most_groups = 0;  ///< shot again at most
  int age_floor = 0;              ///< frames: groups as old as this go before all others; 0: none
  /// Priorities of census and pilots are times age^age_power. 0: as the papers have them; then some groups are never
  /// their turn.
  double age_power = 1;
};

/// Why the map cannot be updated to `header` (of the map to come) with these options; "" if it can: groups, paths,
/// kinds, columns, majorants, emission table and origin must be the same.
std::string why_not_updatable(const formats::PhotonHeader& previous, const formats::PhotonHeader& header);

/// The groups to shoot again at `frame`, ascending. None if `same`: nothing that light depends on has changed (but for
/// `all`). Ties go by a number hashed from frame and group, so that no group is favoured.
std::vector<std::uint32_t> choose_groups(const PreviousMap& previous, int frame, bool same,
                                         const UpdateOptions& options);

/// What is to be done to a map.
struct MapUpdate {
  std::string path;  ///< of the earlier map
  PreviousMap&
      previous;  ///< one that is kept becomes the new map where that is an overlay; else it is not kept any more
  std::span<const std::uint32_t> groups;  ///< to trace again, ascending
  bool may_overlay = false;               ///< the new map lies in the same folder
  /// If given: the chosen groups are not just left out, but taken back by negative photons through the scene of the
  /// frame that they were traced at, whose tracer this gives, as Dmitriev et al. do. It costs a second trace and
  /// changes nothing: paths are drawn from the same numbers, so what is taken back must be what was there (InputError
  /// if it is not). For comparison.
  std::function<const PhotonTracer&(int frame)> corrective;
};

/// Writes the map of `header` through `sink`: the chosen groups traced, all others as the earlier map has them. If at
/// most half of the groups differ from the base, as an overlay upon it, else whole (and with `corrective`).
PhotonMapResult write_updated_map(const PhotonTracer& tracer, const PhotonOptions& options,
                                  formats::PhotonHeader header, const MapUpdate& update,
                                  const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
