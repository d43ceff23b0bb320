// lib/filter/blur.h -- motion blur and depth of field made from a sharp frame (docs/methods/blur.md).
#pragma once

#include "lib/filter/flow_path.h"
#include "lib/image/image.h"

namespace tempolux {

/// The shutter and the lens of a camera.
struct BlurOptions {
  double opens = 0, closes = 0;  ///< frames from the frame's time; equal: no motion blur
  /// A point at depth z is seen in a disc of this radius [pixels] x |1 / focus_m - 1 / z| x 1 m; 0: no lens.
  double lens_px = 0;
  double focus_m = 1;  ///< what is sharp; may be infinite
};

/// Pixels that the way of a point while the shutter is open, or its disc, may be long. Longer ones are shortened.
inline constexpr float kLongestBlur = 512;

/// Blurs R, G, B and A. Z says what is in front, `flow` where it moves. Z, N, P, id and motion stay sharp; channels
/// that would no longer fit, such as layers, are removed. Throws InputError if the image has no R, G, B or no Z.
Image blur_frame(Image image, const FlowFrame& flow, const BlurOptions& options);

}  // namespace tempolux
