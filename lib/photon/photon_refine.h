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

/// Distributes `extra` further paths over the groups and returns the number of paths of each group. The numbers
/// minimise the variance, which is the sum of moment / paths, without taking paths from a group: a group gets paths
/// in proportion to the square root of its moment, if that is more than it has (Neyman 1934). If all moments are 0,
/// each group gets the same share. Both spans are by group; the whole numbers add up exactly.
std::vector<std::uint64_t> spread_paths(std::span<const double> moments, std::span<const std::uint64_t> paths,
                                        std::uint64_t extra);

/// For each group, the mean over its neighbours: the groups whose boxes of start points share a face with its own. A
/// group's own value is left out, since its number of paths must not depend on what its own paths found: otherwise
/// lucky groups would be corrected and unlucky ones not (docs/methods/volume_photons.md). `values` are by group of
/// PhotonHalton(seed). If the number of groups is not 2^a 3^b 5^c 7^d there are no boxes, and all groups get the mean
/// of all.
std::vector<double> neighbour_means(std::span<const double> values, std::uint64_t seed);

/// For each group of a map: its number of paths, and the second moment of one path's contribution to the light in
/// media, W^2. The contribution is the flux that collides at tentative photons if the path were the only one of its
/// group; the moment is the mean over paths of the sum of its squares, estimated from the neighbouring groups.
struct GroupMoments {
  formats::PhotonHeader header;
  std::vector<formats::GroupFlux> ledger;
  std::vector<std::uint64_t> paths;
  std::vector<double> moments;
};
/// Reads the whole map. `tracer` must have the map's frame and seed. Throws InputError unless the map has photons in
/// media.
GroupMoments read_moments(const std::string& path, const PhotonTracer& tracer);

/// Writes the map at `path` with `extra` further paths. A photon of group g then has the flux Phi / (N_g n_g), with
/// Phi the flux of its light path if it were the only one, N_g the number of groups and n_g the paths of the group.
/// Existing photons are scaled by n_g before / n_g after; new paths continue the group's Halton sequence. Every group
/// carries 1 / N_g of the flux, so a group with many paths is not brighter. `header` is the new map's.
PhotonMapResult write_refined_map(const PhotonTracer& tracer, formats::PhotonHeader header, const std::string& path,
                                  const GroupMoments& groups, std::uint64_t extra,
                                  const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
