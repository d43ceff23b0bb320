// lib/render/pixel_noise.h -- how many samples pixels need, by what their neighbours saw.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/core/parallel_array.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {

/// Variance of what n, sum and sum of squares are of; 0 of one.
double sample_variance(double n, double sum, double square);
/// Samples of a pixel that are to leave it the error pixel_error x (min(level, picture) + picture / 10), if sigma is the noise of one,
/// level the radiance around it and picture the picture's mean (docs/pixels.md); 0 if no error is asked for.
double wanted_samples(double sigma, double level, double picture, double pixel_error);

/// Noise of a picture whose pixels have their first samples, and what more they need. With sigma the standard deviation of a
/// sample as far as stratification leaves it and L the radiance, both around a pixel, L at most the picture's mean, it needs
///
///     n = 12 (sigma / (12 e))^(3/4),     e = FrameOptions::pixel_error (L + mean / 10)
///
/// Stratified samples err as n^(-5/6) or so, and the least error of a picture for a number of samples then has n ~ sigma^(3/4);
/// 12 is where the error of a pixel is e. sigma^2 is the mean over the 24 neighbours, of what has edges (all layers but direct)
/// over the 8 nearest and between them (docs/pixels.md).
class PixelNoise {
 public:
  PixelNoise(const CameraView& view, const FrameOptions& options);

  /// Pixels whose first samples are needed: all, or of a masked frame those that say what a masked pixel needs: so it gets as many
  /// samples as in the whole frame. As FrameOptions::mask; empty: all.
  const std::vector<std::uint8_t>& looked_at() const { return looked_at_; }
  int first_half() const { return first_half_; }   ///< of the first samples: the others are the second half
  /// The two halves of a pixel's first samples. Thread-safe for different pixels.
  void note(std::size_t pixel, const PixelSum& first, const PixelSum& second);
  /// By pixel, once all are noted.
  std::vector<int> missing_samples();

 private:
  struct Pixel {
    double mean = 0;                       ///< of the first samples, mean of the channels; its square may be beyond float
    double smooth_difference = 0;          ///< of layer direct: mean over half of them less that over the others
    double sharp = 0, sharp_variance = 0;  ///< of one of them, of all other layers
  };
  static constexpr double kOnLattice = 4096;   ///< pixels, about: their mean errs by 1 % where they differ by 60 %
  // Pixels: one is judged by the 24 around it; by 8 for what has edges, which are narrow: all that see one pay for it.
  static constexpr int kNear = 2, kNearSharp = 1;

  template <class Body>
  void for_each_neighbour(int x, int y, int near, const Body& body) const;
  double smooth_variance(int x, int y) const;
  double sharp_variance(int x, int y) const;
  double level_around(int x, int y) const;
  bool on_lattice(int x, int y) const { return x % lattice_ == lattice_ / 2 && y % lattice_ == lattice_ / 2; }
  void look_around_mask();

  const CameraView& view_;
  const FrameOptions& options_;
  int first_half_;
  double picture_ = 0;   ///< mean of the first samples of the pixels of a lattice
  int lattice_;          ///< pixels from one of them to the next
  std::vector<std::uint8_t> looked_at_;
  ParallelArray<Pixel> pixels_;
};

}  // namespace tempolux
