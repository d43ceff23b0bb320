// lib/pilot/missed_light.h -- light that a way to light misses, by its three sources.
#pragma once

#include <algorithm>

namespace tempolux {

/// Light of one layer that the samples of a way miss (docs/methods/missed-light.md). Errors are in the unit of
/// SampleEffort, shares are of the picture's light.
struct MissedLight {
  // Photons show more light than paths found.
  double square = 0;    ///< squared error of a picture without the light that paths miss with certainty
  double variance = 0;  ///< lower bound of the variance of one path that might find it
  // Few samples hold the light.
  double lone = 0;       ///< share above white that a single sample of its place holds
  double uncertain = 0;  ///< share whose mean does not certainly differ from 0, because too few samples hold it; else 0
  // No path can find the light.
  double never = 0;  ///< share of lights without extent, by mirrors and smooth glass (hidden_share)

  /// Squared error that n samples leave of the light that photons show; at most the square of all the light.
  double left(double samples) const { return std::min(square, variance / samples); }
};

}  // namespace tempolux
