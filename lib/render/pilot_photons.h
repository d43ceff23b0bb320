// lib/render/pilot_photons.h -- traces a few photons in memory, for pilots.
#pragma once

#include <cstdint>
#include <string>

#include "formats/photons/photons.h"
#include "lib/light/lights.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Light paths of a pilot. A share p of them is known to sqrt(p (1 - p) / 32768): .3 % at most.
inline constexpr std::uint64_t kPilotPaths = 1 << 15;

/// Photons of `paths` light paths (rounded up to a multiple of PhotonTracer::kBatch) of the given kinds, named as for
/// photon-trace --kinds, in the order of their paths. Positions are in scene space [m], flux in W. Same photons for any
/// number of threads.
formats::PhotonBlock pilot_photons(const Tracer& tracer, const Lights& lights, const std::string& kinds,
                                   std::uint64_t paths, std::uint64_t seed);

}  // namespace tempolux
