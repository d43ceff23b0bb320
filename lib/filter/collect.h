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

/// Collects one half of the light, frame after frame, so that only two frames need to be in memory. The weight of a
/// neighbouring frame at a pixel is value_weight() of the difference between its guide and the middle frame's guide.
/// Both guides are those of the other half.
///
/// Each pixel of the middle frame is followed along the flow from frame to frame, to the closest pixel. It is lost for
/// the remaining frames if that pixel
/// - lies outside the picture,
/// - shows another object, or a normal that is turned by more than PixelSurfaces::kSameNormal, or
/// - has flow that does not lead back to the start (kReturnShare, kReturnSquare).
class Collector {
 public:
  /// All that `middle` refers to must outlive this object.
  Collector(const WindowFrame& middle, std::size_t half);

  /// Starts a direction in time. The next calls of add() pass the frames after the middle frame (1) or before it (-1),
  /// the closest first.
  void start(int direction);
  void add(const WindowFrame& frame);
  /// Returns the collected light; call once, at the end. The light is a weighted mean over the frames in which the
  /// pixel has Surfaces::use, or over all frames if it has `use` in none.
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
  Plane edge_weight_;  ///< weight of pixels without `use`; while no pixel with `use` was found `out_` holds their light
};

}  // namespace tempolux
