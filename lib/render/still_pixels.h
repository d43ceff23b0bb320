// lib/render/still_pixels.h -- finds the pixels that change little between two moments, and their change.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/image/image.h"
#include "lib/render/frame_noise.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {

/// The pixels of a frame that are kept from a frame of another moment, and how much they change.
struct StillPixels {
  std::vector<std::uint8_t> anew;  ///< by pixel: 1 if the pixel must be sampled anew, 0 if it is kept
  LayerImage change;               ///< of kept pixels: radiance now minus radiance before; of the others: 0
  Image noise_channels;            ///< noise and variance of the change (add_variance_channels); empty without halves
  FrameNoise noise;                ///< of the change, as the kept pixels show it
  RayCounts rays, noise_rays;
  double share_anew() const;     ///< share of the pixels that must be sampled anew
  double work = 1;               ///< of the samples, over the work of a frame that keeps no pixels
  double samples_per_pixel = 0;  ///< mean number of camera rays at each of the two moments
};

/// Compares samples of a frame (`now`) with samples of another moment (`before`, which may also be a later frame) that
/// are taken with the same random numbers. Where nothing that a sample meets has changed, both samples are equal, and
/// their difference has no noise. So
///     radiance now = radiance before + mean of the differences
/// has no bias, and little noise where little changes.
///
/// PixelNoise estimates from the first samples of neighbours how many differences a pixel needs for the frame's pixel
/// error, and how many plain samples. A pixel gets what costs less: it is kept and gets differences, or it is sampled
/// anew. This choice adds no bias. If the difference of one sample alone moves a kept pixel by more than the pixel may
/// err, the excess is spread evenly over the kept pixels around; the sum over pixels stays the same.
///
/// The samplers must have the same view, the same seed and the same guide to the sky. `base` is the frame before; the
/// noise in codes is measured at its brightness. The options are those of the frame. The result does not depend on the
/// number of threads.
StillPixels still_pixels(const CameraSampler& now, const CameraSampler& before, const Image& base,
                         const FrameOptions& options);

/// Pixels along an edge of the pieces of a frame that still_work() looks at: most pixels of a piece have the neighbours
/// that they have in the frame.
inline constexpr int kPixelsOfPiece = 12;

/// StillPixels::work, from the first samples of pieces of the frame, which are spread evenly over it. `pieces`: a view
/// with as many pixels as the pieces have together, at most as wide and high as the frame. onward: false if the part
/// onward does not count, because the frames will read its light from records.
double still_work(const CameraSampler& now, const CameraSampler& before, const CameraView& pieces,
                  const FrameOptions& options, bool onward);

/// Adds the change to the pixels that are not sampled anew: to the layers that `image` has, to their noise and
/// variance, and to R G B A. R G B are the exact sum of the layers if `image` has all of them.
void add_change(const StillPixels& still, Image& image);

}  // namespace tempolux
