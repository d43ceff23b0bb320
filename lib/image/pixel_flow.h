// lib/image/pixel_flow.h -- pixel flow: where what a pixel shows is in the next frame and was in the previous one
// (formats/flow/flow.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/image.h"

namespace tempolux {

/// Bits of PixelFlow::valid.
enum FlowValid : std::uint32_t { forward_known = 1, backward_known = 2 };

/// The flow of frame F, one entry per pixel, row 0 on top.
struct PixelFlow {
  int width = 0, height = 0;
  std::vector<Vec2> forward;         ///< pixels, x right, y **up**: place in frame F+1 minus place now; 0 if not known
  std::vector<Vec2> backward;        ///< the same for frame F-1
  std::vector<std::uint32_t> valid;  ///< FlowValid: which of the two are known; a known one may be 0: it stands
  std::vector<float> speed;          ///< deg/s as the eye at the camera sees it, >= 0; 0 if nothing is known

  PixelFlow() = default;
  /// Nothing known.
  PixelFlow(int width, int height);
};

/// Adds the flow's six channels to an image of its size.
void add_flow_channels(const PixelFlow& flow, Image& image);

/// What add_flow_channels() added. Throws InputError, beginning with `name`, if one of the channels is absent or of
/// another type, if a vector or speed is infinite, speed is below 0, or `valid` has other bits than FlowValid.
PixelFlow flow_in(const Image& image, const std::string& name);

}  // namespace tempolux
