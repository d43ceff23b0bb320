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
/// q = p + (dx, dy) in the window. The weight is from[h].weight(q) on p's surface (SurfaceEight), else 0. If
/// there are guides, the weight is multiplied by value_weight() of the other half's guides, (*guides)[1 - h]: a half's
/// own noise must not choose its weights. A plane keeps a linear gradient of light also at the border of a surface,
/// where a weighted mean would not. The result is negative only if the weighted mean is. If no pixel of the window has
/// a weight, p keeps its value. The weight of the result is the sum of the weights.
///
/// The guides of the result are the sums of its layers. Their variance is 3 `variance` / weight, where `variance` is
/// that of one half's pixel, smoothed. The factor lies between the middle of a window, where a plane's value has the
/// variance of a mean, and its border, where it has 4 times this variance.
BothHalves fit(const Surfaces& surfaces, const BothHalves& from, const BothHalves* guides, const FitOptions& options,
               const Plane& variance);

/// Means of `values` over the pixels within 5 x 5 that lie on the pixel's surface and have `use`; the pixel's own value
/// if there are none.
Plane smoothed(const Surfaces& surfaces, const Plane& values);

/// Fits add kPull times the sum of weights to the second moments, which pulls slopes towards 0. The slopes are then
/// unique even if all pixels of a window are in one column.
inline constexpr float kPull = 0.02f;

/// Weight of a value for the mean at another value, by their difference: Tukey's biweight, which is 0 from five
/// standard errors on. `square` is the squared difference, `variance` the variance of the difference.
inline constexpr float kValueErrors = 5, kTinyVariance = 1e-30f;
inline float value_weight(float square, float variance) {
  const float z = 1 - square / (kValueErrors * kValueErrors * variance + kTinyVariance);
  return z > 0 ? z * z : 0.0f;
}
/// Variance of the rounding of a float; `square` is the square of its value.
template <class T>
T rounding_variance(T square) {
  return 1e-12f * square;
}

}  // namespace tempolux
