// lib/render/frame_noise.h -- measures a frame's noise: some pixels are rendered twice.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/render/camera_view.h"
#include "lib/render/path_tracer.h"
#include "lib/render/pixel_variance.h"
#include "lib/render/pixels_around.h"

namespace tempolux {

/// Root of the mean squared error by noise over pixels and channels, with its standard error. Below 0: not measured.
struct Noise {
  double linear = -1, linear_error = 0;  ///< W/m^2/sr
  double codes = -1, codes_error = 0;    ///< 8-bit sRGB codes, 0 to 255, at FrameNoise::exposure
};

struct FrameNoise {
  Noise image;  ///< noise of the sum of all layers
  /// The part of image.codes that comes from noise of records and photons. All samples read the same records and
  /// photons, so further samples do not reduce this part.
  double stored_codes = 0;
  std::array<Noise, kLayerCount> layer;      ///< noise of each layer alone, at the exposure of the whole picture
  double exposure = 0;                       ///< factor that brings the median of the pixels' mean channels to .18
  std::size_t pixels = 0;                    ///< number of pixels that were rendered twice
  bool known() const { return pixels > 1; }  ///< two pixels at least give a standard error
};

/// Relative error of a linear value of .18 that changes the value's sRGB code by `codes`. At .18 the slope of the curve
/// is 255 x 1.055 / 2.4 x .18^(1 / 2.4 - 1) = 305 codes.
constexpr double pixel_error_of_codes(double codes) { return codes * (1 / (305 * 0.18)); }
/// exposure_of() and mean_to_white() (lib/image/srgb.h) of the sums of all layers, mean of the channels, over the
/// pixels of the mask (empty: all).
double exposure_of(std::span<const Layers> pixels, std::span<const std::uint8_t> mask);
double mean_to_white(std::span<const Layers> pixels, std::span<const std::uint8_t> mask);

/// Measures noise by pixels that are rendered a second time, with different random numbers and the same numbers of
/// samples. Let x and y be a pixel's means in the two renderings. Then the expectation of (x - y)^2 / 2 is the variance
/// of x. Stratified samples make this variance smaller than that of independent samples. A comparison of the two halves
/// of one rendering would not find the true variance: both halves are stratified together and have opposite errors, so
/// their squared difference is up to 4 times too large.
class NoiseCheck {
 public:
  /// Takes one pixel of each square. The edge of the squares is 5 to 8 pixels, such that about 1024 pixels are taken,
  /// or more in large pictures and fewer in small ones. The second rendering costs 1/64 to 1/25 of the frame's rays.
  NoiseCheck(const CameraView& view, std::uint64_t seed, std::span<const std::uint8_t> mask);
  /// Index of pixel (x, y) among the pixels that are rendered twice, or kNone.
  std::uint32_t slot(int x, int y) const;
  std::size_t size() const { return again_.size(); }
  /// Seed of the second rendering.
  std::uint64_t seed() const { return seed_; }
  /// Mean of the second rendering of a pixel by its slot(), by part. The caller fills it. Thread-safe for different
  /// slots.
  PathParts& again(std::uint32_t slot) { return again_[slot]; }
  /// Noise of `picture`, whose pixels are as_sampled(pixel) before spread_outliers changed them. Let x be the sampled
  /// value, y the second rendering, z the value in `picture`, g = max(0, z - x) the light that the pixel got from other
  /// pixels, x' = x + g and y' = y + g. The variance of z is about E (z - y')^2 - E (x' - y')^2 / 2: the second term
  /// removes the variance of y'. Both renderings read the same records and photons, so the square of stored_noise
  /// (LayerImage::stored_noise; may be empty) is added.
  template <class AsSampled>
  FrameNoise measure(const std::vector<Layers>& picture, const AsSampled& as_sampled,
                     std::span<const StoredNoise> stored_noise = {}) const {
    std::vector<Triple> triples;
    for_each_pixel_of_grid([&](std::size_t pixel, std::uint32_t slot) {
      Layers stored;
      if (!stored_noise.empty())
        for (const Layer layer : {Layer::caustic, Layer::indirect}) stored[layer] = *stored_noise[pixel].of(layer);
      triples.push_back({picture[pixel], as_sampled(pixel), again_[slot].sum(), stored});
    });
    return measure(triples, exposure_of(picture, mask_));
  }

  /// Halves of the samples of the second rendering. Thread-safe for different slots.
  SampleHalves& again_halves(std::uint32_t slot) { return again_halves_[slot]; }
  /// By layer: the variance of a pixel's mean over the mean square of SampleHalves::difference, at most 1.
  ///
  /// Let x = as_sampled(pixel) and y be the means of the two renderings, and d and e the differences of their halves.
  /// The result is the weighted sum of (x - y)^2 over the weighted sum of d^2 + e^2. One factor of a pixel's weight is
  /// the squared slope of the sRGB curve at x + y plus the layer's mean. The other factor is the inverse root of the
  /// local plus the global mean of d^2, so that a few noisy pixels do not dominate. The ratio from n pixels has a
  /// relative variance of about 3 / n, and layers differ by a factor of about 2, whose logarithm has the variance .5.
  /// So the ratio of all layers together enters each layer's ratio as 3 / .5 = 6 further pixels.
  template <class AsSampled>
  std::array<double, kLayerCount> shares(const std::vector<SampleHalves>& halves, const AsSampled& as_sampled) const {
    std::vector<Twice> pixels;
    for_each_pixel_of_grid([&](std::size_t pixel, std::uint32_t slot) {
      Twice& twice = pixels.emplace_back(Twice{as_sampled(pixel), again_[slot].sum(), {}, {}, {}});
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        twice.first.value[l] = halves[pixel].difference(l);
        twice.second.value[l] = again_halves_[slot].difference(l);
        const int x = int(pixel % std::size_t(width_)), y = int(pixel / std::size_t(width_));
        for_each_around(width_, height_, x, y, 1, [&](std::size_t near, int, int) {
          const Rgb d = halves[near].difference(l);
          twice.around.value[l] += d * d;
        });
      }
    });
    return shares(pixels);
  }

 private:
  struct Twice {
    Layers once, again, first, second, around;  ///< x, y, d, e, and the sum of d^2 over the eight neighbours
  };
  static std::array<double, kLayerCount> shares(std::vector<Twice>& pixels);
  struct Triple {
    Layers shown, sampled, again, stored;
  };
  template <class Body>
  void for_each_pixel_of_grid(const Body& body) const;
  FrameNoise measure(const std::vector<Triple>& triples, double exposure) const;

  std::uint64_t seed_;
  std::span<const std::uint8_t> mask_;
  int width_, height_, edge_, columns_;
  std::vector<PathParts> again_;
  std::vector<SampleHalves> again_halves_;
};

/// Noise of `mean` = (a + b) / 2 from two independent halves of a frame. The variance is E (a - b)^2 / 4.
FrameNoise noise_of_halves(std::span<const Layers> mean, std::span<const Layers> a, std::span<const Layers> b);

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
