// lib/render/frame_noise.h -- how noisy a frame is, measured: some pixels are rendered twice.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// RMSE that noise leaves, over pixels and channels, with its standard error; below 0: not known.
struct Noise {
  double linear = -1, linear_error = 0;   ///< W/m^2/sr
  double codes = -1, codes_error = 0;     ///< 8-bit sRGB codes, 0 to 255, at FrameNoise::exposure
};

struct FrameNoise {
  Noise image;
  std::array<Noise, kLayerCount> layer;   ///< each layer looked at alone, at the exposure of the image
  double exposure = 0;                    ///< factor that puts the median of pixels' mean channels at .18
  std::size_t pixels = 0;                 ///< that were rendered twice
  bool known() const { return pixels > 1; }
};

/// sRGB code of a linear value, 0 to 255, not rounded; the value is clipped at 0 and 1.
double srgb_code(double value);
/// Factor that puts the median of the pixels' mean channels at .18; if more than half are black, the median of those that are not; 1 of a black picture.
double exposure_of(std::span<const Layers> pixels, std::span<const std::uint8_t> mask);

/// Pixels of a grid are rendered a second time, with random numbers of their own and as many samples: x and y. Then E (x - y)^2 / 2 is the variance of x,
/// whatever stratification leaves of it. The two halves of a pixel's own samples do not say that: samples that are stratified together
/// have halves with opposite errors, so their difference is too large, by up to 4 times in variance.
class NoiseCheck {
 public:
  /// One pixel of each square of edge 5 to 8, so that a frame has 1000 or more of them where it can. Costs 1/64 to 1/25 of the frame's rays.
  NoiseCheck(const CameraView& view, std::uint64_t seed, std::span<const std::uint8_t> mask);
  /// Index of the pixel among those that are rendered twice, or kNone.
  std::uint32_t slot(int x, int y) const;
  std::size_t size() const { return again_.size(); }
  /// The second rendering's.
  std::uint64_t seed() const { return seed_; }
  /// Mean of the second rendering by part. Thread-safe for different slots.
  PathParts& again(std::uint32_t slot) { return again_[slot]; }
  /// Noise of `picture`, whose pixels are `as_sampled(pixel)` where nothing has been done to them, else what spread_outliers made of them: with z for the latter the error is
  /// E (z - y)^2 - E (x - y)^2 / 2, the bias of single pixels included.
  template <class AsSampled>
  FrameNoise measure(const std::vector<Layers>& picture, const AsSampled& as_sampled) const {
    std::vector<Triple> triples;
    for_each_pixel_of_grid([&](std::size_t pixel, std::uint32_t slot) { triples.push_back({picture[pixel], as_sampled(pixel), again_[slot].sum()}); });
    return measure(triples, exposure_of(picture, mask_));
  }

 private:
  struct Triple {
    Layers shown, sampled, again;
  };
  template <class Body>
  void for_each_pixel_of_grid(const Body& body) const;
  FrameNoise measure(const std::vector<Triple>& triples, double exposure) const;

  std::uint64_t seed_;
  std::span<const std::uint8_t> mask_;
  int width_, height_, edge_, columns_;
  std::vector<PathParts> again_;
};

/// Of two independent halves of a frame: E (a - b)^2 / 4 is the variance of (a + b) / 2.
FrameNoise noise_of_halves(const std::vector<Layers>& a, const std::vector<Layers>& b);

template <class Body>
void NoiseCheck::for_each_pixel_of_grid(const Body& body) const {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t pixel = std::size_t(y) * std::size_t(width_) + std::size_t(x);
      const std::uint32_t at = slot(x, y);
      if (at != kNone && (mask_.empty() || mask_[pixel])) body(pixel, at);
    }
}

}  // namespace tempolux
