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
  census,  ///< groups whose stored photons saw most change: sum of flux x |change of extinction|
  fde,     ///< groups with pilots that see another extinction (first difference in the extinction)
  dip,     ///< groups with pilots that media scatter at other places (different interaction point)
  hybrid,  ///< by the change of extinction along pilots, and their flux
  path,  ///< groups with pilots that media scatter at other places, that hit other surfaces, or that start differently
  all,   ///< every group, whether or not anything has changed
};

/// True if the strategy traces pilots.
constexpr bool sends_pilots(UpdateStrategy s) {
  return s == UpdateStrategy::fde || s == UpdateStrategy::dip || s == UpdateStrategy::hybrid ||
         s == UpdateStrategy::path;
}

/// The data of an earlier map from which groups are chosen.
struct PreviousMap {
  formats::PhotonHeader header;
  /// Digest of the whole map; not updated for a map kept in memory. An overlay on an overlay takes the digest of its
  /// base from the header instead.
  std::string digest;
  std::vector<formats::GroupFlux> ledger;  ///< every group
  /// One number for each group, by strategy. census: sum over its tentative photons of flux x |extinction now - then|,
  /// W. fde, dip, path: share of its pilots that differ. hybrid: sum over its pilots of |difference of the sketches|,
  /// W. Empty for other strategies.
  std::vector<double> change;
  std::uint64_t pilot_paths = 0;  ///< pilot paths traced
  /// For a map kept in memory: the photons of each group, and the groups that an overlay holds itself.
  std::vector<std::vector<formats::PhotonBlock>> photons;
  std::set<std::uint32_t> own;
  bool is_kept() const { return !photons.empty(); }
  /// Makes this the map kept in memory that has been updated. `updated`: entries of the groups that it holds itself.
  void become(const formats::PhotonHeader& now, std::span<const formats::GroupFlux> updated,
              std::set<std::uint32_t> groups) {
    header = now;
    for (const formats::GroupFlux& entry : updated) ledger[entry.group] = entry;
    own = std::move(groups);
  }
};

/// Reads the whole map and computes PreviousMap::change against the tracer's scene; `origin` is the scene's. With
/// `keep` the photons stay in memory, and the change is left to find_change(). Throws InputError if the strategy needs
/// pilots and the map has none.
PreviousMap read_previous(const std::string& path, const PhotonTracer& tracer, UpdateStrategy strategy, Vec3d origin,
                          bool keep = false);

/// Computes PreviousMap::change of a map kept in memory, against the scene of another frame's tracer.
void find_change(const std::string& path, PreviousMap& previous, const PhotonTracer& tracer, UpdateStrategy strategy,
                 Vec3d origin);

/// Groups whose blocks an overlay holds itself.
std::set<std::uint32_t> own_groups(const std::string& path);

}  // namespace tempolux
