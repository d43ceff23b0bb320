// lib/compose/phase_share.h -- who brings light of a direction to the eye: photons, or rays that the phase function
// sends on.
#pragma once

#include <cmath>

#include "lib/compose/fluence_volume.h"
#include "lib/volume/phase.h"

namespace tempolux {

/// Light that a medium scatters towards the eye is found in two ways. Photons fly in all directions, more or less
/// evenly, and count by the phase function p; where p has a peak few of them carry nearly all. Rays from the eye are
/// sent on by p itself. Light of each direction is divided between the two by the balance heuristic (Veach and Guibas
/// 1995), so that their sum is what either alone has in the mean. With q = 4 pi p, the phase function over that of even
/// scattering:
///
///     share of photons = n / (n + m q)     n photons in the filter, m rays of a pixel
///
/// Photons then count n / m times evenly scattered ones at most. In the mean any n and m are right; noise depends on
/// them.
class PhaseShare {
 public:
  /// `rays` = 0: photons bring everything.
  explicit PhaseShare(float g, int rays) {
    const float a = std::min(std::abs(g), kLargestG), peak = (1 + a) / ((1 - a) * (1 - a));  // largest q
    if (peak * float(rays) > kPhotonsInFilter) per_photon_ = float(rays) / kPhotonsInFilter;
  }
  /// Are there directions of which rays bring more than photons? Else rays bring nothing.
  bool has_rays() const { return per_photon_ > 0; }
  float of_photons(float q) const { return 1 / (1 + per_photon_ * q); }
  float of_rays(float q) const { return 1 - of_photons(q); }

 private:
  float per_photon_ = 0;  ///< m / n
};

}  // namespace tempolux
