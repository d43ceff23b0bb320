// tests/lib/aqm/synthetic.h -- frames whose error is known: constants, and noise of known variance.
#pragma once

#include <functional>

#include "lib/aqm/frame_error.h"
#include "lib/core/random.h"

namespace tempolux::synthetic {

/// Zero-mean noise of variance 1, uniform on +-sqrt(3), for (seed, pixel, channel).
inline double noise(std::uint64_t seed, std::size_t pixel, std::uint32_t channel) {
  const double u = unit_double(PathRandom(seed, pixel).bits(0, Purpose::test, channel));
  return (2 * u - 1) * 1.7320508075688772;
}

/// R, G, B from a function of pixel and channel.
inline Image rgb_image(int width, int height, const std::function<double(std::size_t, std::uint32_t)>& value,
                       const std::string& layer = "") {
  Image image;
  image.width = width;
  image.height = height;
  for (std::uint32_t c = 0; c < 3; ++c) {
    Channel& channel = image.add((layer.empty() ? "" : layer + ".") + std::string(1, "RGB"[c]));
    for (std::size_t i = 0; i < channel.values.size(); ++i) channel.values[i] = float(value(i, c));
  }
  return image;
}

inline Image constant_image(int width, int height, double value) {
  return rgb_image(width, height, [=](std::size_t, std::uint32_t) { return value; });
}

/// value + sigma noise.
inline Image noisy_image(int width, int height, double value, double sigma, std::uint64_t seed) {
  return rgb_image(width, height, [=](std::size_t i, std::uint32_t c) { return value + sigma * noise(seed, i, c); });
}

inline Compared compare(const Image& test, const Image& reference, const Image* second = nullptr,
                        const Image* mask = nullptr, const std::string& layer = "") {
  return compare_layers({{&test, "x.exr"}, {&reference, "r.exr"}, {second, "r2.exr"}, {mask, "mask.exr"}, layer});
}

inline FrameError errors_of(const Image& test, const Image& reference, const Image* second = nullptr,
                            const Image* mask = nullptr, const std::string& layer = "") {
  return figures_of(sum_errors(compare(test, reference, second, mask, layer), 0), 64);
}

}  // namespace tempolux::synthetic
