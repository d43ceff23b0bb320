// lib/filter/collect.h -- the light of one frame and of those around it, brought together along the pixel flow.
#pragma once

#include <cstddef>
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

/// Brings frames together one by one, so that no more than two need to be in memory. A neighbour counts as far as its means agree with the
/// middle's (value_weight), or where noise is not known by its frame's weight alone.
///
/// Each pixel of the middle is followed from frame to frame. It is lost for good where the nearest pixel lies outside the picture, shows another
/// object or a normal turned by more than PixelSurfaces::kSameNormal, or has come from elsewhere: the flow there and back ends more than
/// kReturn pixels, and kReturnShare of its length, from where it began.
class Collector {
 public:
  /// middle: its light outlives this, its flow start(). weight: of the frame. in_time: pixels where it is 0 take nothing from other frames;
  /// nullptr: all do.
  Collector(const WindowFrame& middle, float weight, const Plane* in_time);

  /// From here on add() takes the frames after the middle (direction 1) or before it (-1), the nearest first.
  void start(const FlowFrame& middle, int direction);
  void add(const WindowFrame& frame, float weight);
  /// Once, at the end.
  Collected take();

 private:
  struct Strip;   // pixels of a row
  void follow(const Strip& strip, const WindowFrame& frame, Lane& weights, std::array<std::uint32_t, kStrip>& there);
  void add(const Strip& strip, const LightFrame& frame, const Lane& weights, const std::array<std::uint32_t, kStrip>& there);

  const LightFrame& frame_;
  const Plane* in_time_;
  int direction_ = 0;
  Plane px_, py_;              ///< where each pixel is in the next frame, pixel centres are whole numbers; not a number: lost
  Plane right_, down_;         ///< the last step there
  Collected out_;              ///< sums of it
  Plane edge_weight_;          ///< of pixels that are of no use, where none is: `light` holds theirs
  Plane mean_weight_;
};

}  // namespace tempolux
