// lib/photon/photon_update.h -- selective photon tracing: of an earlier map some groups are shot again, the others kept.
//
// Paper: Dmitriev et al. 2002; Jimenez, Myszkowski, Pueyo 2005. Method: docs/methods/volume_photons.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/photon/photon_map.h"

namespace tempolux {

/// Which groups go first.
enum class UpdateStrategy : std::uint8_t {
  oldest,   ///< those traced longest ago
  random,   ///< any, others at each frame
  census,   ///< where the stored photons saw most change: sum of worth x |change of extinction|, times age
  all,      ///< every group, whatever has changed
};

struct UpdateOptions {
  UpdateStrategy strategy = UpdateStrategy::oldest;
  std::uint64_t most_groups = 0;             ///< shot again at most
  int age_floor = 0;                         ///< frames: groups as old as this go before all others; 0: none
};

/// What an earlier map says that a choice needs.
struct PreviousMap {
  formats::PhotonHeader header;
  std::string digest;                        ///< of the whole map
  std::vector<formats::GroupFlux> ledger;    ///< every group
  std::vector<double> change;                ///< by group: sum over its tentative photons of worth x |extinction now - then|, W; census only
};

/// Reads the map to its end. `census`: also PreviousMap::change, against the media of the tracer's frame; `origin` is the scene's.
PreviousMap read_previous(const std::string& path, const PhotonTracer& tracer, bool census, Vec3d origin);

/// Why the map cannot be updated to `header` (of the map to come) with these options; "" if it can: groups, paths, kinds, columns,
/// majorants, emission table and origin must be the same.
std::string why_not_updatable(const formats::PhotonHeader& previous, const formats::PhotonHeader& header);

/// The groups to shoot again at `frame`, ascending. None if `same`: nothing that light depends on has changed (but for `all`).
/// Ties go by a number hashed from frame and group, so that no group is favoured.
std::vector<std::uint32_t> choose_groups(const PreviousMap& previous, int frame, bool same, const UpdateOptions& options);

/// Writes the map of `header` through `sink`: the chosen groups traced, all others as `path` has them. If that is possible and at most half
/// of the groups differ from the base, as an overlay upon it (in the same folder; `may_overlay`), else whole.
PhotonMapResult write_updated_map(const PhotonTracer& tracer, const PhotonOptions& options, formats::PhotonHeader header,
                                  const std::string& path, const PreviousMap& previous, std::span<const std::uint32_t> groups,
                                  bool may_overlay, const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
