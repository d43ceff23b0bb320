// lib/photon/photon_map.h -- traces a photon map and writes it to a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "formats/photons/photons.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

struct PhotonMapResult : PhotonCounts {
  formats::PhotonTotals totals;               ///< as written to the file
  std::vector<formats::TouchedPath> touched;  ///< if the tracer watches movers: touched paths, in the order of the map
};

/// Traces all photons and writes them in file order through `sink`. Batches are traced and encoded in parallel and
/// written one after another. Few of them exist at once, so memory does not grow with the number of photons. `header`
/// identifies the scene; this function fills in counts and kinds. The same bytes for any number of threads. `progress`
/// is called with values in [0, 1]; it may be empty.
PhotonMapResult write_photon_map(const PhotonTracer& tracer, formats::PhotonHeader header,
                                 const std::function<void(const void*, std::size_t)>& sink,
                                 const std::function<void(double)>& progress);

}  // namespace tempolux
