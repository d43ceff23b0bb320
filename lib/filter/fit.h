// lib/filter/fit.h -- the filter in space: fits a plane to the light around each pixel.
#pragma once

#include "lib/filter/light.h"

namespace tempolux {

struct FitOptions {
  int radius = 2;      ///< windows have 2 radius + 1 pixels a side; 1 or 2
  int stride = 1;      ///< distance in pixels between the window's pixels; radius * stride is at most kMargin
  bool alike = false;  ///< both halves get the same weights, and guides are not used
};

/// For each half h, pixel p, layer and channel: the value at p of the plane
///     a + b dx + c dy   with the least sum over q of   weight(p, q) (light(q) - a - b dx - c dy)^2,
/// q = p + (dx, dy) in the window. The weight is from[h].weight(q); 0 off p's surface (PixelSurfaces::same); and if
/// there are guides, times value_weight of the other half's guides, (*guides)[1 - h], so that a half's own noise does
/// not choose its weights. A plane keeps a linear gradient of light also at the border of a surface, where a weighted
/// mean would not. The result is not negative unless the weighted mean is. Where no pixel has a weight, p keeps its
/// value. The weight of the result is the sum of the weights.
/// Guides of the result are the sums of its layers. Their variance is 3 `variance` (of one half's pixel, smoothed) over
/// the weight: at the border of a window a plane's value has 4 times the variance of a mean, in the middle the same.
BothHalves fit(const Surfaces& surfaces, const BothHalves& from, const BothHalves* guides, const FitOptions& options,
               const Plane& variance);

/// Means of `values` over the pixels of the surface within 5 x 5 that have `use`; the own value if there is none.
Plane smoothed(const Surfaces& surfaces, const Plane& values);

/// Weight of two values by their difference: Tukey's biweight, zero from five standard errors on. `square` is the
/// squared difference, `variance` the variance of the difference.
inline constexpr float kValueErrors = 5, kTinyVariance = 1e-30f;
inline float value_weight(float square, float variance) {
  const float z = 1 - square / (kValueErrors * kValueErrors * variance + kTinyVariance);
  return z > 0 ? z * z : 0.0f;
}
/// Variance that rounding alone gives to floats of this size.
template <class T>
T rounding_variance(T square) {
  return 1e-12f * square;
}

}  // namespace tempolux
