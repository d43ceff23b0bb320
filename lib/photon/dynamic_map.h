// lib/photon/dynamic_map.h -- what movers change in a photon map, by common random numbers (docs/methods/dynamic.md).
#pragma once

#include <functional>
#include <span>

#include "lib/photon/photon_map.h"

namespace tempolux {

/// What write_dynamic_map writes of these paths, all of one group; at least one.
PhotonBatch difference_of(const PhotonTracer& standing, const PhotonTracer& whole,
                          std::span<const std::uint64_t> paths);

/// Follows each of `paths` twice, through the scene as it stands and through the whole scene, and writes the
/// difference: photons of the standing scene with negative flux, those of the whole scene with positive flux, from
/// where the two part. Both tracers have the same options, paths and random numbers, so that
///     static map + dynamic map = global map
/// photon by photon, if `paths` holds every path that a mover touches. They come in the order of the map: groups
/// ascending, in a group ascending. The totals are differences, too. The same bytes for any number of threads.
PhotonMapResult write_dynamic_map(const PhotonTracer& standing, const PhotonTracer& whole,
                                  std::span<const std::uint64_t> paths, const PhotonOptions& options,
                                  formats::PhotonHeader header,
                                  const std::function<void(const void*, std::size_t)>& sink,
                                  const std::function<void(double)>& progress);

}  // namespace tempolux
