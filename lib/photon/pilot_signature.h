// lib/photon/pilot_signature.h -- hashes what a pilot path meets. Equal paths have equal hashes; different paths
// have different hashes with probability 1 - 2^-64.
#pragma once

#include <bit>
#include <cstdint>

#include "formats/photons/photons.h"
#include "lib/core/random.h"
#include "lib/trace/trace.h"

namespace tempolux::pilot_signature {

inline void add(std::uint64_t& hash, std::uint64_t word) { hash = mix64(hash ^ word) + 0x9e3779b97f4a7c15ull; }
inline std::uint64_t bits(float a, float b) {
  return std::uint64_t(std::bit_cast<std::uint32_t>(a)) << 32 | std::bit_cast<std::uint32_t>(b);
}

/// Adds the path's start and flux [W].
inline void start(formats::PhotonPilot& pilot, const Ray& ray, Rgb flux) {
  for (const auto& [a, b] :
       {std::pair{ray.origin.x, ray.origin.y}, std::pair{ray.origin.z, ray.direction.x},
        std::pair{ray.direction.y, ray.direction.z}, std::pair{flux.r, flux.g}, std::pair{flux.b, 0.0f}})
    add(pilot.vertices, bits(a, b));
}

/// Adds a tentative collision in a medium: flux [W], extinction and majorant [1/m]. `positive`: a random bit of the
/// place, the sign with which the collision counts in the sketch.
inline void look(formats::PhotonPilot& pilot, bool positive, Rgb flux, float extinction, float majorant) {
  add(pilot.extinctions, std::bit_cast<std::uint32_t>(extinction));
  const double share = double((flux.r + flux.g + flux.b) / 3) * double(extinction) / double(majorant);
  pilot.sketch += positive ? share : -share;
}

/// Adds a real collision: bounce of the path, and number of the tentative collision since the last bounce.
inline void collide(formats::PhotonPilot& pilot, std::uint32_t bounce, std::uint32_t step) {
  add(pilot.collisions, std::uint64_t(bounce) << 32 | step);
}

/// Adds a hit on a surface.
inline void meet(formats::PhotonPilot& pilot, std::uint32_t bounce, const Hit& hit) {
  add(pilot.vertices, std::uint64_t(bounce) << 32 | std::bit_cast<std::uint32_t>(hit.t));
  add(pilot.vertices, std::uint64_t(hit.surface) << 32 | hit.triangle);
}

}  // namespace tempolux::pilot_signature
