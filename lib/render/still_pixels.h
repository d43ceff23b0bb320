// lib/render/still_pixels.h -- finds the pixels that change little between two moments, and their change.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {

/// The pixels of a frame that are kept from a frame of another moment, and how much they change.
struct StillPixels {
  std::vector<std::uint8_t> anew;  ///< by pixel: 1 if the pixel must be sampled anew, 0 if it is kept
  std::vector<Layers> change;      ///< by pixel, of kept pixels: radiance now minus radiance before [W/m^2/sr]
  RayCounts rays;
  double share_anew() const;  ///< share of the pixels that must be sampled anew
};

/// Compares the first samples of a frame (`now`) with samples of another moment (`before`, which may also be a later
/// frame) that are taken with the same random numbers. Where nothing that a sample meets has changed, both samples are
/// equal, and their difference has no noise. So
///     radiance now = radiance before + mean of the differences
/// has no bias, and little noise where little changes.
///
/// PixelNoise estimates from the differences of neighbours how many samples a pixel's differences need for the frame's
/// pixel error. If the first samples do not suffice, the pixel is sampled anew. This choice adds no bias. If the
/// difference of one sample alone moves a kept pixel by more than the pixel may err, the excess is spread evenly over
/// the kept pixels around; the sum over pixels stays the same.
///
/// The samplers must have the same view, the same seed and the same guide to the sky. The options are those of the
/// frame. The result does not depend on the number of threads.
StillPixels still_pixels(const CameraSampler& now, const CameraSampler& before, const FrameOptions& options);

/// Adds the change to the pixels that are not sampled anew: to the layers that `image` has, and to R G B A. R G B are
/// the exact sum of the layers if `image` has all of them.
void add_change(const StillPixels& still, Image& image);

}  // namespace tempolux
