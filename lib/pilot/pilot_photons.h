// lib/pilot/pilot_photons.h -- traces a few photons in memory, for pilots; from them, the number of light paths of a
// map.
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
                                   std::uint64_t paths, std::uint64_t seed, bool directions = false);

/// Largest number of light paths over the usual number. With it photons cost as much as all other stages: 16 x .25 CPU
/// s.
inline constexpr double kMostTimesPhotons = 16;

/// Number of light paths of a photon map: `usual` where at least one path in 70 leaves a photon, else 2, 4, 8 or 16
/// times as many. The steps keep the number constant when the scene changes a little. Source of the 70: if one path in
/// 70 leaves a photon, 700 thousand paths leave N = 10 thousand photons. In a cubic room of width w and surface A = 6
/// w^2, the 50 photons of an estimate then lie within the radius r = .1 w, from N pi r^2 / A = 50. With fewer photons
/// the light of a small opening shows as single spots on the walls (figures: docs/methods/aim.md).
std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual);

}  // namespace tempolux
