// lib/filter/features.h -- what the pixels of a frame show on the mean.
#pragma once

#include <array>
#include <cstddef>

#include "lib/filter/plane.h"
#include "lib/image/image.h"

namespace tempolux {

/// Means over the pixel, and over lens and shutter: of the normal, of 1 / depth and of albedo
/// (formats/frames/frames.md). In a pixel that several surfaces share, each feature is linear in their shares, as
/// radiance is.
struct Features {
  static constexpr std::size_t kCount = 7;
  std::array<Plane, kCount> mean;
  std::array<Plane, kCount> variance;  ///< of the mean, itself averaged over 3 x 3 pixels

  /// Empty planes if the image does not have the channels coverage.mean.*.
  explicit Features(const Image& image);
  bool known() const { return !mean[0].empty(); }
};

}  // namespace tempolux
