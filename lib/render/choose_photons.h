// lib/render/choose_photons.h -- how many light paths a photon map needs in scenes where few paths leave a photon.
#pragma once

#include <cstdint>

namespace tempolux {

/// Number of light paths: `usual` where at least one path in 70 leaves a photon, else 2, 4, 8 or 16 times as many. The
/// steps keep the number constant when the scene changes a little. The limit of 1 in 70 leaves 10 thousand photons of
/// 700 thousand paths: in a cubic room of width w, the 50 photons of an estimate then lie within r = .1 w (50 A / (pi
/// r^2) = 10^4 with A = 6 w^2). With fewer photons the light of a small opening shows as single spots on the walls.
/// docs/methods/aim.md has the figures.
std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual);

}  // namespace tempolux
