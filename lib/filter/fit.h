// lib/filter/fit.h -- the filter in space: a plane fitted to the light around each pixel, by pixels of its surface that
// agree with it.
#pragma once

#include "lib/filter/light.h"

namespace tempolux {

struct FitOptions {
  int radius = 2;      ///< windows have 2 radius + 1 places a side, at most kMostPlaces
  int stride = 1;      ///< pixels from one place to the next; radius * stride is at most kMargin
  bool alike = false;  ///< both halves have the same weights, and there are no guides
};
inline constexpr int kMostPlaces = 5;

/// For each half h, pixel p, layer and channel the value at p of
///     a + b dx + c dy   that has the least sum over q of   weight(p, q) (light(q) - a - b dx - c dy)^2,
/// q = p + (dx, dy) in the window, weight = from[h].weight(q), 0 off p's surface (PixelSurfaces::same), times
/// value_weight of the guides of the other half,
/// (*guides)[1 - h], if there are guides: which pixels count is not decided by their own noise. A plane keeps light
/// that changes evenly as it is, also at the border of a surface, where a weighted mean would not. Not below 0 if the
/// mean is not. Where no pixel counts p keeps what it has. The weight of the result is the sum of the weights.
///
/// Guides of the result: the sums of its layers. Their variance is 3 `variance` (of one half's pixel, smoothed) over
/// the weight: at the border of a window a plane knows its value by 4 times less than a mean does, in the middle by as
/// much.
BothHalves fit(const Surfaces& surfaces, const BothHalves& from, const BothHalves* guides, const FitOptions& options,
               const Plane& variance);

/// Means of `values` over 5 x 5 pixels of the surface that are of use; its own where there is none.
Plane smoothed(const Surfaces& surfaces, const Plane& values);

/// How much two values that differ may have to do with each other. `square`: of their difference, `variance` of it.
/// Tukey's biweight, zero from five standard errors on.
inline constexpr float kValueErrors = 5, kTinyVariance = 1e-30f;
inline float value_weight(float square, float variance) {
  const float z = 1 - square / (kValueErrors * kValueErrors * variance + kTinyVariance);
  return z > 0 ? z * z : 0.0f;
}
/// Variance by which floats of this size differ from rounding alone.
template <class T>
T rounding_variance(T square) {
  return 1e-12f * square;
}

}  // namespace tempolux
