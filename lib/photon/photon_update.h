// lib/photon/photon_update.h -- selective photon tracing: of an earlier map some groups are shot again, the others kept.
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

namespace tempolux {

/// Which groups go first.
enum class UpdateStrategy : std::uint8_t {
  oldest,   ///< those traced longest ago
  random,   ///< any, others at each frame
  census,   ///< where the stored photons saw most change: sum of worth x |change of extinction|
  fde,      ///< pilots that look at another extinction than before (first difference in the extinction)
  dip,      ///< pilots that media scatter at other places (different interaction point)
  hybrid,   ///< by how much the extinction differs that pilots look at, and their flux
  path,     ///< pilots that media scatter at other places, or that meet other surfaces or start otherwise
  all,      ///< every group, whatever has changed
};

/// Does the strategy send pilots?
constexpr bool sends_pilots(UpdateStrategy s) {
  return s == UpdateStrategy::fde || s == UpdateStrategy::dip || s == UpdateStrategy::hybrid || s == UpdateStrategy::path;
}

struct UpdateOptions {
  UpdateStrategy strategy = UpdateStrategy::oldest;
  std::uint64_t most_groups = 0;             ///< shot again at most
  int age_floor = 0;                         ///< frames: groups as old as this go before all others; 0: none
  /// Priorities of census and pilots are times age^age_power. 0: as the papers have them; then some groups are never their turn.
  double age_power = 1;
};

/// What an earlier map says that a choice needs.
struct PreviousMap {
  formats::PhotonHeader header;
  std::string digest;                        ///< of the whole map
  std::vector<formats::GroupFlux> ledger;    ///< every group
  /// By group, for strategies that ask for it. Census: sum over its tentative photons of worth x |extinction now - then|, W. fde, dip, path:
  /// share of its pilots that differ. hybrid: sum over its pilots of |difference of the sketches|, W.
  std::vector<double> change;
  std::uint64_t pilot_paths = 0;             ///< paths traced for it
};

/// Reads the map to its end and finds PreviousMap::change against the scene of the tracer's frame; `origin` is the scene's. InputError if
/// the strategy needs pilots and the map has none.
PreviousMap read_previous(const std::string& path, const PhotonTracer& tracer, UpdateStrategy strategy, Vec3d origin);

/// Why the map cannot be updated to `header` (of the map to come) with these options; "" if it can: groups, paths, kinds, columns,
/// majorants, emission table and origin must be the same.
std::string why_not_updatable(const formats::PhotonHeader& previous, const formats::PhotonHeader& header);

/// The groups to shoot again at `frame`, ascending. None if `same`: nothing that light depends on has changed (but for `all`).
/// Ties go by a number hashed from frame and group, so that no group is favoured.
std::vector<std::uint32_t> choose_groups(const PreviousMap& previous, int frame, bool same, const UpdateOptions& options);

/// What is to be done to a map.
struct MapUpdate {
  std::string path;                          ///< of the earlier map
  const PreviousMap& previous;
  std::span<const std::uint32_t> groups;     ///< to trace again, ascending
  bool may_overlay = false;                  ///< the new map lies in the same folder
  /// If given: the chosen groups are not just left out, but taken back by negative photons through the scene of the frame that they were
  /// traced at, whose tracer this gives, as Dmitriev et al. do. It costs a second trace and changes nothing: paths are drawn
  /// from the same numbers, so what is taken back must be what was there (InputError if it is not). For comparison.
  std::function<const PhotonTracer&(int frame)> corrective;
};

/// Writes the map of `header` through `sink`: the chosen groups traced, all others as the earlier map has them. If at most half of the groups
/// differ from the base, as an overlay upon it, else whole (and with `corrective`).
PhotonMapResult write_updated_map(const PhotonTracer& tracer, const PhotonOptions& options, formats::PhotonHeader header,
                                  const MapUpdate& update, const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
