// lib/filter/collect.h -- the light of one frame and of those around it, brought together along the pixel flow.
#pragma once

#include <cstddef>
#include <vector>

#include "lib/filter/flow_path.h"
#include "lib/filter/lane.h"
#include "lib/filter/light.h"

namespace tempolux {

/// One frame of the window: its matte light, the first fits of that (fit.h), where its pixels go.
struct WindowFrame {
  const LightGroup* light = nullptr;
  const BothHalves* guides = nullptr;
  const FlowFrame* flow = nullptr;
};

/// Brings one half of the light of frames together, one frame after the other, so that no more than two need to be in
/// memory. A neighbour counts as far as the guides of the other half agree with the middle's (value_weight).
///
/// Each pixel of the middle is followed from frame to frame. It is lost for good where the nearest pixel lies outside
/// the picture, shows another object or a normal turned by more than PixelSurfaces::kSameNormal, or has come from
/// elsewhere: the flow there and back ends more than kReturn pixels, and kReturnShare of its length, from where it
/// began.
class Collector {
 public:
  /// What `middle` points to outlives this.
  Collector(const WindowFrame& middle, std::size_t half);

  /// From here on add() takes the frames after the middle (direction 1) or before it (-1), the nearest first.
  void start(int direction);
  void add(const WindowFrame& frame);
  /// Once, at the end: weighted means over frames, of pixels that are of use; if none is, of all.
  Light take();

 private:
  struct Strip;  // pixels of a row
  void follow(const Strip& strip, const WindowFrame& frame, Lane& weights, std::array<std::uint32_t, kStrip>& there);
  void add(const Strip& strip, const LightGroup& frame, const Lane& weights,
           const std::array<std::uint32_t, kStrip>& there);

  const WindowFrame middle_;
  const Surfaces& surfaces_;
  std::size_t half_;
  int direction_ = 0;
  Plane px_, py_;       ///< where each pixel is in the next frame, pixel centres are whole numbers; not a number: lost
  Plane right_, down_;  ///< the last step there
  Light out_;           ///< sums of it; guides as the middle's
  Plane edge_weight_;   ///< of pixels that are of no use, where none is: the layers hold theirs
};

}  // namespace tempolux
