// lib/photon/photon_map.h -- trace a whole photon map straight into a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "formats/photons/photons.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

struct PhotonMapResult {
  formats::PhotonTotals totals;  ///< photon_count and stored_flux as the writer counted them
  std::uint64_t path_count = 0, ray_count = 0, specular_ray_count = 0, medium_steps = 0;
  std::uint64_t seen_count = 0;               ///< photons stored in the spheres of Lights::aim()
  std::vector<formats::TouchedPath> touched;  ///< if the tracer watches movers: in the order of the map
};

/// Traces all photons and writes them in file order through `sink`: batches are traced and encoded in
/// parallel, written by one thread, with a fixed number in flight, so memory does not grow with the count.
/// `header` says where the photons belong; its counts and kinds are filled in here. The same bytes for any
/// number of threads. `progress` is called with [0, 1]; may be empty.
PhotonMapResult write_photon_map(const PhotonTracer& tracer, const PhotonOptions& options, formats::PhotonHeader header,
                                 const std::function<void(const void*, std::size_t)>& sink,
                                 const std::function<void(double)>& progress);

}  // namespace tempolux
