// lib/photon/photon_refine.h -- further photons in the groups of a map where they help most, all flux balanced.
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

/// Paths of each group so that they are `extra` more in all and the variance, sum of moment / paths, is least, none
/// getting fewer than it has: paths in proportion to the square root of the moment where that is more than there are
/// (Neyman 1934). Where all moments are 0: evenly. Both spans by group; whole numbers that add up exactly.
std::vector<std::uint64_t> spread_paths(std::span<const double> moments, std::span<const std::uint64_t> paths,
                                        std::uint64_t extra);

/// For each group the mean over the groups beside it, whose boxes of starts share a face with its own. Its own value is
/// left out: how many paths a group gets must not depend on what its own paths found, or the lucky are corrected and
/// the unlucky are not (docs/methods/volume_photons.md). `values` by group, of PhotonHalton(seed). Where the number of
/// groups is not 2^a 3^b 5^c 7^d they have no boxes: all get the mean of all.
std::vector<double> beside_groups(std::span<const double> values, std::uint64_t seed);

/// For each group of a map: paths, and the second moment of what one of its paths adds to the light in media, W^2: mean
/// over its paths of the sum of squares of (flux that collides at a tentative photon, were it the only path of the
/// group), estimated from the groups beside it.
struct GroupMoments {
  formats::PhotonHeader header;
  std::vector<formats::GroupFlux> ledger;
  std::vector<std::uint64_t> paths;
  std::vector<double> moments;
};
/// Reads the map to its end. `tracer`: of the map's frame and seed. InputError unless it has photons in media.
GroupMoments read_moments(const std::string& path, const PhotonTracer& tracer);

/// Writes the map at `path` with `extra` further paths. A group's photons carry Phi / (N_g n_g) then, n_g its paths:
/// those it has are scaled by n_g before / after, new ones continue its Halton sequence. So flux is first divided among
/// the groups, and a group with many paths is not brighter than others. `header`: of the map to come.
PhotonMapResult write_refined_map(const PhotonTracer& tracer, const PhotonOptions& options,
                                  formats::PhotonHeader header, const std::string& path, const GroupMoments& groups,
                                  std::uint64_t extra, const std::function<void(const void*, std::size_t)>& sink);

}  // namespace tempolux
