// lib/render/choose_photons.h -- how many light paths a photon map needs in scenes where few paths leave a photon.
#pragma once

#include <cstdint>

namespace tempolux {

/// With this many times the usual photons, photons cost about as much as all other stages: 16 x .25 s.
inline constexpr double kMostTimesPhotons = 16;

/// Number of light paths: `usual` where at least one path in 70 leaves a photon, else 2, 4, 8 or 16 times as many. The
/// steps keep the number constant when the scene changes a little. Source of the limit: if 1 of 70 paths leaves a
/// photon, 700 thousand paths leave N = 10 thousand photons. In a cubic room of width w and surface A = 6 w^2, the 50
/// photons of an estimate then lie within the radius r = .1 w, from N pi r^2 / A = 50. With fewer photons the light of
/// a small opening shows as single spots on the walls (figures: docs/methods/aim.md).
std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual);

}  // namespace tempolux
