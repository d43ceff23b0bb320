// lib/photon/previous_map.h -- an earlier photon map, read to choose the groups to trace again.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

/// Which groups are traced again first.
enum class UpdateStrategy : std::uint8_t {
  oldest,  ///< the groups with the oldest photons
  random,  ///< random groups, others in each frame
  census,  ///< groups with the largest change at their stored photons: sum of flux x |change of extinction|
  fde,     ///< groups with most pilots that meet another extinction (first difference in the extinction)
  dip,     ///< groups with most pilots that media scatter at other places (different interaction point)
  hybrid,  ///< groups with the largest change of extinction along pilots, weighted by flux
  path,    ///< groups with most pilots that scatter at other places, hit other surfaces, or start differently
  all,     ///< every group, whether or not anything has changed
};

/// True if the strategy traces pilots.
constexpr bool sends_pilots(UpdateStrategy s) {
  return s == UpdateStrategy::fde || s == UpdateStrategy::dip || s == UpdateStrategy::hybrid ||
         s == UpdateStrategy::path;
}

/// An earlier map: the data from which groups are chosen, and the photons if the map is kept in memory.
struct PreviousMap {
  formats::PhotonHeader header;
  /// Digest of the map's file, which an overlay on this map stores. Not updated for a map kept in memory: such a map is
  /// an overlay itself, and an overlay on an overlay takes the base and its digest from the header.
  std::string digest;
  std::vector<formats::GroupFlux> ledger;  ///< every group
  /// The change of each group. census: sum over its tentative photons of flux x |extinction now - then|, W. fde, dip,
  /// path: share of its pilots that differ. hybrid: sum over its pilots of |difference of the sketches|, W. Empty for
  /// other strategies.
  std::vector<double> change;
  std::uint64_t pilot_paths = 0;  ///< pilot paths traced to compute `change`
  /// For a map kept in memory: the photons of each group, and the groups that the map holds itself if it is an overlay.
  std::vector<std::vector<formats::PhotonBlock>> photons;
  std::set<std::uint32_t> own;
  bool is_kept() const { return !photons.empty(); }
  /// Turns this map into an overlay that has been written. `updated`: ledger of the overlay's `groups`.
  void become(const formats::PhotonHeader& now, std::span<const formats::GroupFlux> updated,
              std::set<std::uint32_t> groups) {
    header = now;
    for (const formats::GroupFlux& entry : updated) ledger[entry.group] = entry;
    own = std::move(groups);
  }
};

/// Reads the whole map. If `keep` is set the photons stay in memory, and the caller calls find_change(); otherwise the
/// function computes PreviousMap::change by comparison with the tracer's scene. `origin` [m]: origin of the scene.
/// Throws InputError if the strategy needs pilots and the map has none.
PreviousMap read_previous(const std::string& path, const PhotonTracer& tracer, UpdateStrategy strategy, Vec3d origin,
                          bool keep = false);

/// Computes PreviousMap::change of a map kept in memory by comparison with the scene of another frame's tracer.
void find_change(const std::string& path, PreviousMap& previous, const PhotonTracer& tracer, UpdateStrategy strategy,
                 Vec3d origin);

/// The groups whose photons an overlay file stores itself. The photons of the other groups are in its base.
std::set<std::uint32_t> own_groups(const std::string& path);

}  // namespace tempolux
