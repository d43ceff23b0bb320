// lib/render/still_pixels.h -- finds the pixels that change little between two moments, and their change.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {

/// A frame that another frame of the same camera gives most pixels to.
struct StillPixels {
  std::vector<std::uint8_t> anew;  ///< by pixel: 1 if the pixel must be sampled anew
  /// By pixel that need not: radiance now minus radiance before [W/m^2/sr], by layer.
  std::vector<Layers> change;
  RayCounts rays;
  double share_anew() const;  ///< of the pixels
};

/// Compares the first samples of a frame with samples of a moment before, taken with the same random numbers. Where
/// nothing that a sample meets has changed, both samples are equal, and their difference has no noise. So
///     radiance now = radiance before + mean of the differences
/// has no bias, and little noise where little changes. A pixel is sampled anew if its differences would need further
/// samples for the frame's pixel error, by the noise of its neighbours' differences (PixelNoise): this adds no bias.
/// If the difference of one sample alone moves a kept pixel by more than it may err, the excess is spread evenly over
/// the kept pixels around, so the sum over pixels stays the same.
/// Both samplers have the same view, seed and guide to the sky; `options`: those of the frame. Same result for any
/// number of threads.
StillPixels still_pixels(const CameraSampler& now, const CameraSampler& before, const FrameOptions& options);

/// Adds the change to the pixels that are not sampled anew: to the layers that `image` has, and to R G B A. R G B are
/// the exact sum of the layers if `image` has all of them.
void add_change(const StillPixels& still, Image& image);

}  // namespace tempolux
