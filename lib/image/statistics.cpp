#include "lib/image/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "lib/image/srgb.h"

namespace tempolux {
namespace {

double sample(const Channel& channel, std::size_t pixel) {
  return channel.ids.empty() ? double(channel.values[pixel]) : double(channel.ids[pixel]);
}

ChannelStatistics statistics_of(const Channel& channel, std::size_t pixels) {
  ChannelStatistics result{channel.name, !channel.ids.empty(), 0, 0, 0, 0, 0, 0};
  double low = std::numeric_limits<double>::infinity(), high = -low, sum = 0;
  std::uint64_t finite = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double value = sample(channel, i);
    if (std::isnan(value)) {
      ++result.nans;
    } else if (std::isinf(value)) {
      ++result.infinities;
    } else {
      ++finite;
      result.zeros += value == 0;
      low = std::min(low, value);
      high = std::max(high, value);
      sum += value;
    }
  }
  if (finite > 0) result.min = low, result.max = high, result.mean = sum / double(finite);
  return result;
}

}  // namespace

std::vector<ChannelStatistics> channel_statistics(const Image& image) {
  std::vector<ChannelStatistics> all;
  for (const Channel& channel : image.channels) all.push_back(statistics_of(channel, image.pixel_count()));
  return all;
}

std::vector<ChannelDifference> channel_differences(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw std::invalid_argument("channel_differences: images of different sizes");
  std::vector<ChannelDifference> all;
  for (const Channel& channel : a.channels) {
    const Channel* other = b.find(channel.name);
    if (!other) continue;
    ChannelDifference difference{channel.name, 0, 0, 0, 0};
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
      const double x = sample(channel, i), y = sample(*other, i);
      if (x == y || (std::isnan(x) && std::isnan(y))) continue;
      ++difference.differing;
      const double distance = std::abs(x - y);
      if (!std::isfinite(distance) || distance <= difference.largest) continue;
      difference.largest = distance;
      difference.x = int(i % std::size_t(a.width));
      difference.y = int(i / std::size_t(a.width));
    }
    all.push_back(difference);
  }
  return all;
}

double sequence_exposure_stops(std::vector<double> stops) {
  if (stops.empty()) throw std::invalid_argument("sequence_exposure_stops: no frames");
  const auto middle = stops.begin() + std::ptrdiff_t((stops.size() - 1) / 2);
  std::nth_element(stops.begin(), middle, stops.end());
  return *middle;
}

std::array<std::uint8_t, 3> point_color(const std::array<float, 3>& flux, double white) {
  std::array<std::uint8_t, 3> color{};
  if (!(white > 0)) return color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = std::uint8_t(std::lround(255.0f * linear_to_srgb(float(double(flux[c]) / white))));
  return color;
}

}  // namespace tempolux
