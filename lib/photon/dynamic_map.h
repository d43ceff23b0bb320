// lib/photon/dynamic_map.h -- traces the dynamic map: the difference that movers make, by common random numbers
// (docs/methods/dynamic.md).
#pragma once

#include <functional>
#include <span>

#include "lib/photon/photon_map.h"

namespace tempolux {

/// The photons and counts that write_dynamic_map makes of these paths: at least one path, all of one group.
PhotonBatch difference_of(const PhotonTracer& static_scene, const PhotonTracer& whole,
                          std::span<const std::uint64_t> paths);

/// Traces each of `paths` twice, through the static scene and through the whole scene, and writes the difference: from
/// the point where the two paths differ, photons of the static scene with negative flux and photons of the whole scene
/// with positive flux. Both tracers have the same options, paths and random numbers, so
///     static map + dynamic map = global map
/// photon by photon, if `paths` holds every path that a mover touches. Photons come in the order of a map: groups
/// ascending, paths of a group ascending. The totals are differences, too. The same bytes for any number of threads.
PhotonMapResult write_dynamic_map(const PhotonTracer& static_scene, const PhotonTracer& whole,
                                  std::span<const std::uint64_t> paths, formats::PhotonHeader header,
                                  const std::function<void(const void*, std::size_t)>& sink,
                                  const std::function<void(double)>& progress);

}  // namespace tempolux
