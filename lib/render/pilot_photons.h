// lib/render/pilot_photons.h -- a few photons in memory: for pilots.
#pragma once

#include <cstdint>
#include <string>

#include "formats/photons/photons.h"
#include "lib/light/lights.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Photons of `paths` paths (rounded up to a multiple of PhotonTracer::kBatch), of these kinds as photon-trace --kinds
/// names them, in the order of their paths. Positions are in the scene's space [m], flux in W. Same photons for any
/// number of threads.
formats::PhotonBlock pilot_photons(const Tracer& tracer, const Lights& lights, const std::string& kinds,
                                   std::uint64_t paths, std::uint64_t seed);

}  // namespace tempolux
