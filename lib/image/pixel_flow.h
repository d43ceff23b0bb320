// lib/image/pixel_flow.h -- pixel flow: the motion of each pixel's surface point to the next and the previous frame
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
  std::vector<Vec2> forward;   ///< pixels, x right, y **up**: position in frame F+1 minus position in F; 0 if unknown
  std::vector<Vec2> backward;  ///< position in frame F-1 minus position in F, likewise
  std::vector<std::uint32_t> valid;  ///< FlowValid: which vectors are known; a known vector may be 0
  std::vector<float> speed;          ///< deg/s, seen from the camera, >= 0; 0 if unknown

  PixelFlow() = default;
  /// All vectors unknown.
  PixelFlow(int width, int height);
};

/// Adds the flow's six channels to an image of its size.
void add_flow_channels(const PixelFlow& flow, Image& image);

/// Reads the channels of add_flow_channels(). Throws InputError "NAME: ..." if a channel is missing or of another type,
/// a vector or speed is not finite, a speed is negative, or `valid` has other bits than FlowValid.
PixelFlow flow_in(const Image& image, const std::string& name);

}  // namespace tempolux
