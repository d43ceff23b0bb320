// lib/compose/phase_share.h -- divides the light in a medium between photons and rays drawn from the phase function.
#pragma once

#include <cmath>

#include "lib/compose/fluence_volume.h"
#include "lib/volume/phase.h"

namespace tempolux {

/// Light that a medium scatters towards the eye is estimated in two ways. Photons fly in all directions and are weighed
/// by the phase function p; if p has a peak, few photons carry nearly all light. Rays from the eye are drawn from p
/// itself. The balance heuristic (Veach and Guibas 1995) divides the light of each direction between the two, so that
/// their sum has the right expectation. With q = 4 pi p:
///
///     share of photons = n / (n + m q)     n photons in the filter, m rays per pixel
///
/// The weight of a photon is then at most n / m times an isotropically scattered one's. The expectation is right for
/// any n and m; the noise depends on them.
class PhaseShare {
 public:
  /// `rays` = 0: photons take all light.
  explicit PhaseShare(float g, int rays) {
    const float a = std::min(std::abs(g), kLargestG), peak = (1 + a) / ((1 - a) * (1 - a));  // largest q
    if (peak * float(rays) > kPhotonsInFilter) per_photon_ = float(rays) / kPhotonsInFilter;
  }
  /// True if there are directions of which rays take more light than photons; otherwise rays take none.
  bool has_rays() const { return per_photon_ > 0; }
  float of_photons(float q) const { return 1 / (1 + per_photon_ * q); }
  float of_rays(float q) const { return 1 - of_photons(q); }

 private:
  float per_photon_ = 0;  ///< m / n
};

}  // namespace tempolux
