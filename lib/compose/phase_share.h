// lib/compose/phase_share.h -- divides the light in a medium between photons and rays drawn from the phase function.
#pragma once

#include <cmath>

#include "lib/compose/fluence_volume.h"
#include "lib/volume/phase.h"

namespace tempolux {

/// Light that a medium scatters towards the eye is estimated in two ways. Photons arrive from all directions and have
/// the phase function p as weight; if p has a peak, few photons carry almost all light. The directions of rays are
/// drawn from p. The balance heuristic (Veach and Guibas 1995) divides the light of each direction between both, so
/// that the expectation of their sum is right for any n and m. With q = 4 pi p:
///
///     share of photons = n / (n + m q)     n photons in the filter, m rays per pixel
///
/// The weight of a photon, q times its share, is then at most n / m.
class PhaseShare {
 public:
  /// `rays`: m; 0: photons take all light.
  explicit PhaseShare(float g, int rays) {
    const float a = std::min(std::abs(g), kLargestG), peak = (1 + a) / ((1 - a) * (1 - a));  // largest q
    if (peak * float(rays) > kPhotonsInFilter) per_photon_ = float(rays) / kPhotonsInFilter;
  }
  /// True if in some direction rays would take more light than photons. Otherwise photons take all light.
  bool has_rays() const { return per_photon_ > 0; }
  float of_photons(float q) const { return 1 / (1 + per_photon_ * q); }
  float of_rays(float q) const { return 1 - of_photons(q); }

 private:
  float per_photon_ = 0;  ///< m / n
};

}  // namespace tempolux
