// lib/render/choose_photons.h -- how many paths of light a photon map needs where few of them arrive.
#pragma once

#include <cstdint>
#include <string>

#include "lib/render/path_tracer.h"

namespace tempolux {

/// Photons that the paths of a pilot leave in the scene.
struct ArrivalPilot {
  std::uint64_t paths = 0, photons = 0;
};

/// 32768 paths, photons of these kinds (photon-trace --kinds): a hundredth of a second, as few arrive where it matters. The scene's lights
/// may aim photons where the camera looks. Same result for any number of threads.
ArrivalPilot pilot_arrivals(const RenderScene& scene, const std::string& kinds, std::uint64_t seed);

/// Paths of light: `usual`, but up to 16 times as many where fewer than one in 70 leaves a photon. Of 700 thousand 10 thousand photons are
/// then left: in a room the 50 of an estimate are found within a tenth of its width (50 A / (pi r^2) = 10^4 at A = 6 w^2, r = .1 w). With
/// fewer the light of a small opening lies on walls as single spots. docs/methods/aim.md has the figures.
std::uint64_t photon_paths(const ArrivalPilot& pilot, std::uint64_t usual);

}  // namespace tempolux
