// lib/render/choose_photons.h -- how many paths of light a photon map needs where few of them arrive.
#pragma once

#include <cstdint>

namespace tempolux {

/// Paths of light: `usual`, but 2, 4, 8 or 16 times as many where fewer than one in 70 leaves a photon: in steps, so
/// that a scene that changes a little has the same number. Of 700 thousand 10 thousand photons are then left: in a room
/// the 50 of an estimate are found within a tenth of its width (50 A / (pi r^2) = 10^4 at A = 6 w^2, r = .1 w). With
/// fewer the light of a small opening lies on walls as single spots. docs/methods/aim.md has the figures.
std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual);

}  // namespace tempolux
