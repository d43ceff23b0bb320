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
  double lone = 0;  ///< share of light above white that only one of the samples at a place holds
  /// Share of the layer's light if so few samples hold it that its mean does not certainly differ from 0; else 0.
  double uncertain = 0;
  // No path can find the light.
  double never = 0;  ///< share that lights without extent bring by mirrors and smooth glass (hidden_share)

  /// Squared error that n samples leave of the light that photons show; at most the square of all the light.
  double left(double samples) const { return std::min(square, variance / samples); }
};

}  // namespace tempolux
