// lib/filter/collect.h -- the light of one frame and of those around it, brought together along the pixel flow.
#pragma once

#include <span>
#include <vector>

#include "lib/filter/flow_path.h"
#include "lib/filter/lane.h"

namespace tempolux {

/// A frame's pixels with what neighbours in time add to them.
struct Collected {
  std::vector<ColourPlane> light;   ///< by layer of the frame in the middle: weighted mean over frames, of pixels that are of use; if none is of all. Empty
                                    ///< planes: black in all frames
  Plane weight;                     ///< sum of the weights of those of use: how many frames' worth
  ColourPlane mean;                 ///< LightFrame::mean, over frames
  Plane mean_variance;
};

/// How much two values that differ may have to do with each other. `square`: of their difference, `variance` of it. Tukey's
/// biweight, zero from five standard errors on.
inline constexpr float kValueErrors = 5, kTinyVariance = 1e-30f;
inline float value_weight(float square, float variance) {
  const float z = 1 - square / (kValueErrors * kValueErrors * variance + kTinyVariance);
  return z > 0 ? z * z : 0.0f;
}
inline Float8 value_weight(Float8 square, Float8 variance) {
  const Float8 z = 1 - square / (kValueErrors * kValueErrors * variance + kTinyVariance);
  return where(z > 0, z * z);
}
/// Variance by which floats of this size differ from rounding alone.
template <class T>
T rounding_variance(T square) { return 1e-12f * square; }

/// Brings together window[middle] and the frames around it. A neighbour counts as far as its means agree with the middle's (value_weight), or
/// where noise is not known by `frame_weights`, one for each frame of the window (empty: 1), at pixels where `in_time` is not 0 (nullptr: all).
Collected collect(std::span<const WindowFrame> window, std::size_t middle, std::span<const float> frame_weights, const Plane* in_time);

}  // namespace tempolux
