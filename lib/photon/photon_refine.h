// lib/photon/photon_refine.h -- adds photon paths to the groups of a map that need them most, and rescales all flux.
//
// Paper: Jimenez, Myszkowski, Pueyo 2005, section 5. Method: docs/methods/volume_photons.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/photon/photon_map.h"

namespace tempolux {

/// Distributes `extra` further paths over the groups and returns the new number of paths of each group. The numbers
/// minimise the variance, the sum of moment / paths, under the condition that no group loses paths: a group gets paths
/// in proportion to the square root of its moment, if that is more than the group has (Neyman 1934). If all moments are
/// 0, all groups end with equal numbers as far as possible. Both spans are by group. Exactly `extra` paths are added.
std::vector<std::uint64_t> spread_paths(std::span<const double> moments, std::span<const std::uint64_t> paths,
                                        std::uint64_t extra);

/// For each group, the mean of `values` over its neighbours: the groups whose boxes of start points share a face with
/// the group's box. The group's own value does not count, because its number of paths must not depend on what its own
/// paths found: otherwise groups whose light is too bright by chance would be corrected, and groups that are too dark
/// would not (docs/methods/volume_photons.md). `values` are by group of PhotonHalton(seed). If the number of groups is
/// not 2^a 3^b 5^c 7^d there are no boxes, and all groups get the mean of all values.
std::vector<double> neighbour_means(std::span<const double> values, std::uint64_t seed);

/// The groups of a map.
struct GroupMoments {
  formats::PhotonHeader header;
  std::vector<formats::GroupFlux> ledger;
  std::vector<std::uint64_t> paths;  ///< of each group
  /// W^2, of each group: the mean over its paths of the sum of squares of the flux that collides at the path's
  /// tentative photons, for a path that is the only one of its group. Estimated from the neighbouring groups.
  std::vector<double> moments;
};
/// Reads the whole map. `tracer` must have the map's frame and seed. Throws InputError if the map has no photons in
/// media or other majorants than the tracer.
GroupMoments read_moments(const std::string& path, const PhotonTracer& tracer);

/// Writes the map at `path` with `extra` further paths. A photon of group g then has the flux Phi / (N_g n_g). Phi is
/// the flux that the photon would have if its light path were the only path of the map, N_g is the number of groups,
/// and n_g the number of paths in group g. If a group gets further paths, the flux of its existing photons is
/// multiplied by (old n_g) / (new n_g). New paths continue the group's Halton sequence. All groups bring the same
/// expected flux, so a group with many paths is not brighter. `header`: of the new map.
PhotonMapResult write_refined_map(const PhotonTracer& tracer, formats::PhotonHeader header, const std::string& path,
                                  const GroupMoments& groups, std::uint64_t extra,
                                  const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
