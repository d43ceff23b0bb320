// lib/filter/collect.h -- collects the light of one frame and of its neighbours along the pixel flow.
#pragma once

#include <cstddef>
#include <vector>

#include "lib/filter/flow_path.h"
#include "lib/filter/lane.h"
#include "lib/filter/light.h"

namespace tempolux {

/// One frame of the window: its matte light, the first fits of that light (fit.h), and its pixel flow.
struct WindowFrame {
  const LightGroup* light = nullptr;
  const BothHalves* guides = nullptr;
  const FlowFrame* flow = nullptr;
};

/// Collects one half of the light, frame after frame, so that no more than two frames need to be in memory. A
/// neighbour's weight is the agreement of its guide with the middle frame's guide, both from the other half
/// (value_weight).
/// Each pixel of the middle frame is followed from frame to frame. It is lost for good if the nearest pixel lies
/// outside the picture, shows another object or a normal turned by more than PixelSurfaces::kSameNormal, or came from
/// elsewhere: the flow there and back ends more than kReturn pixels plus kReturnShare of its length from the start.
class Collector {
 public:
  /// All that `middle` refers to must outlive this object.
  Collector(const WindowFrame& middle, std::size_t half);

  /// The next add() calls pass the frames after the middle (direction 1) or before it (-1), the nearest first.
  void start(int direction);
  void add(const WindowFrame& frame);
  /// Returns the collected light; call once, at the end. Weighted means over the frames in which the pixel has `use`;
  /// if there is no such frame, over all frames.
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
  Plane px_, py_;       ///< position of each pixel in the last frame, whole numbers at pixel centres; NaN: lost
  Plane right_, down_;  ///< the last step of each pixel
  Light out_;           ///< sums of the weighted light; guides are the middle frame's
  Plane edge_weight_;   ///< weight of edge pixels, where no pixel with `use` was found; `out_` then holds their light
};

}  // namespace tempolux
