// lib/photon/previous_map.h -- an earlier photon map as the choice of groups sees it, read from its file or kept in
// memory.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

/// Which groups go first.
enum class UpdateStrategy : std::uint8_t {
  oldest,  ///< those traced longest ago
  random,  ///< any, others at each frame
  census,  ///< where the stored photons saw most change: sum of worth x |change of extinction|
  fde,     ///< pilots that look at another extinction than before (first difference in the extinction)
  dip,     ///< pilots that media scatter at other places (different interaction point)
  hybrid,  ///< by how much the extinction differs that pilots look at, and their flux
  path,    ///< pilots that media scatter at other places, or that meet other surfaces or start otherwise
  all,     ///< every group, whatever has changed
};

/// Does the strategy send pilots?
constexpr bool sends_pilots(UpdateStrategy s) {
  return s == UpdateStrategy::fde || s == UpdateStrategy::dip || s == UpdateStrategy::hybrid ||
         s == UpdateStrategy::path;
}

/// What an earlier map says that a choice needs.
struct PreviousMap {
  formats::PhotonHeader header;
  std::string
      digest;  ///< of the whole map; of one that is kept, as it was read: an overlay upon an overlay asks for none
  std::vector<formats::GroupFlux> ledger;  ///< every group
  /// One number for each group, for strategies that ask for it. Census: sum over its tentative photons of worth x
  /// |extinction now - then|, W. fde, dip, path: share of its pilots that differ. hybrid: sum over its pilots of
  /// |difference of the sketches|, W.
  std::vector<double> change;
  std::uint64_t pilot_paths = 0;  ///< paths traced for it
  /// What is known of a map that is kept: the photons of each group, and the groups that an overlay holds itself.
  std::vector<std::vector<formats::PhotonBlock>> photons;
  std::set<std::uint32_t> own;
  bool is_kept() const { return !photons.empty(); }
};

/// Reads the map to its end and finds PreviousMap::change against the scene of the tracer's frame; `origin` is the
/// scene's. `keep`: its photons stay in memory, and finding the change is left to find_change(). InputError if the
/// strategy needs pilots and the map has none.
PreviousMap read_previous(const std::string& path, const PhotonTracer& tracer, UpdateStrategy strategy, Vec3d origin,
                          bool keep = false);

/// PreviousMap::change of a map that is kept, against the scene of another frame's tracer.
void find_change(const std::string& path, PreviousMap& previous, const PhotonTracer& tracer, UpdateStrategy strategy,
                 Vec3d origin);

/// Groups whose blocks an overlay holds itself.
std::set<std::uint32_t> own_groups(const std::string& path);

}  // namespace tempolux
