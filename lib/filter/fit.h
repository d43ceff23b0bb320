// lib/filter/fit.h -- the filter in space: a plane fitted to the light around each pixel, by pixels of its surface that agree with it.
#pragma once

#include <vector>

#include "lib/filter/collect.h"

namespace tempolux {

struct FitOptions {
  int radius = 6;             ///< pixels; windows are squares of 2 radius + 1, at most kMargin
  const Plane* reach2 = nullptr;   ///< pixels^2, by pixel: weights fall off as (1 - distance^2 / reach2)^2, 0 beyond; nullptr: they do not
  bool by_value = true;       ///< pixels count as far as their means agree (value_weight)
};

struct Fitted {
  std::vector<ColourPlane> light;   ///< by layer, of the surface at each pixel's centre
  std::vector<ColourPlane> other;   ///< by layer, of what no centre around shows (unmix.h); empty before
  Plane support;                    ///< sum of the weights: pixels, each times the frames collected in it
};

/// For each pixel p, layer and channel the value at p of
///     a + b dx + c dy   that has the least sum over q of   weight(p, q) (light(q) - a - b dx - c dy)^2,
/// q = p + (dx, dy) in the window, weight = collected.weight(q), 0 off p's surface (PixelSurfaces::same), times value_weight of the means, times what reach2 leaves.
/// A plane keeps light that changes evenly as it is, also at the border of a surface, where a weighted mean would not.
/// Not below 0 if the mean is not. Where no pixel counts, p keeps what was collected.
Fitted fit(const LightFrame& frame, const Collected& collected, const FitOptions& options);

}  // namespace tempolux
