// lib/image/statistics.h -- statistics of channels, differences of two images, and one exposure for a sequence.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// Statistics of one channel over its finite values; min, max and mean are 0 without any.
struct ChannelStatistics {
  std::string name;
  bool ids = false;
  double min = 0, max = 0, mean = 0;
  std::uint64_t zeros = 0, infinities = 0, nans = 0;  ///< numbers of pixels
};
/// One entry per channel, in the image's order. Sums are doubles in pixel order.
std::vector<ChannelStatistics> channel_statistics(const Image& image);

/// Difference of one channel between two images of the same size.
struct ChannelDifference {
  std::string name;
  std::uint64_t differing = 0;  ///< pixels whose bits differ; -0 equals 0 and NaN equals NaN
  double largest = 0;           ///< largest |a - b| over pixels where both are finite; ids are subtracted like values
  int x = 0, y = 0;             ///< first pixel of the largest difference in row order, from the top left
};
/// Compares each channel that both images have, in the order of `a`. Throws std::invalid_argument if the sizes
/// differ.
std::vector<ChannelDifference> channel_differences(const Image& a, const Image& b);

/// One exposure for all frames of a sequence: the lower median of the frames' exposures (auto_exposure_stops), so that
/// a single flash does not darken the other frames. Throws std::invalid_argument if there are none.
double sequence_exposure_stops(std::vector<double> stops);

/// Flux as a display colour: 255 times the sRGB transfer of flux / white, clipped. Black if white is not above 0.
std::array<std::uint8_t, 3> point_color(const std::array<float, 3>& flux, double white);

}  // namespace tempolux
