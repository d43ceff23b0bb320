// lib/render/pixel_noise.h -- how many samples a pixel needs, from the noise of its neighbours.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/core/parallel_array.h"
#include "lib/render/pixel_samples.h"
#include "lib/render/pixels_around.h"

namespace tempolux {

/// Sample variance from the number, sum and sum of squares; 0 for one sample.
double sample_variance(double n, double sum, double square);
/// The error that a pixel may have: e = pixel_error sqrt(l picture + (picture / 10)^2), l = min(level, picture). level
/// is the radiance around the pixel, picture the picture's mean radiance (docs/pixels.md).
double allowed_error(double level, double picture, double pixel_error);
/// Number of samples of one part with which a pixel reaches the error e, if one sample has the standard deviation sigma
/// and costs `cost` rays (docs/pixels.md). 0 if e is 0.
double wanted_samples(double sigma, double cost, double error);
/// x: if all parts take f times their samples, the error of a frame falls by f^-x. wanted_samples() assumes this x.
double error_exponent();
/// Factor for `error` with which wanted_samples() leaves the same noise for a light whose variance is `times` as large:
/// variance / samples ~ variance^(1 - k/2) error^k.
double error_for_variance(double times);

/// Noise of a picture whose pixels have their first samples, and the further samples that they need. docs/pixels.md
/// derives both.
class PixelNoise {
 public:
  PixelNoise(const CameraView& view, const FrameOptions& options);

  /// Pixels whose first samples are needed: all, or with a mask the masked pixels and their neighbours, so that a
  /// masked pixel gets as many samples as in the whole frame. As FrameOptions::mask; empty: all.
  const std::vector<std::uint8_t>& looked_at() const { return looked_at_; }
  /// Numbers of first samples. Rays onward are the most expensive part and often need the fewest samples: half as many
  /// are enough to measure their noise. A frame that will be filtered gets all of them, because it may get no others.
  const PartCounts& first() const { return first_; }
  /// Stores the sums over the two halves of a pixel's first samples, and the number of rays that their part `onward`
  /// took. Thread-safe for different pixels.
  void note(std::size_t pixel, const PixelSum& first, const PixelSum& second, std::uint64_t onward_rays);
  /// Call after note() of all pixels and before wanted_at().
  void all_noted();
  /// Number of samples of each part that a pixel is to have in all: `times` as many as pixel_error asks for, within the
  /// limit.
  PartCounts wanted_at(int x, int y, double times) const;
  /// The error that a pixel may have if the radiance around it is `level` [W/m^2/sr].
  double error_at(double level) const { return allowed_error(level, picture_, options_.pixel_error); }

 private:
  struct Pixel {
    double mean = 0;                     ///< mean channel of the first samples; its square may exceed a float's range
    double lit_difference = 0;           ///< mean over the first half of the samples minus mean over the second half
    double seen = 0, seen_variance = 0;  ///< mean and variance of one sample of the part `own` without layer specular
    double mirrored_variance = 0;        ///< variance of one sample of layer specular
    double onward = 0, onward_variance = 0;
    float onward_rays = 0;  ///< rays of one sample of the part onward
  };
  /// Approximate number of lattice pixels: their mean has an error of 1 % if single pixels differ by 60 %.
  static constexpr double kOnLattice = 4096;
  // Pixels. Noise is also estimated from the 80 pixels around a pixel (docs/pixels.md). For light with edges it is
  // estimated from 8 pixels, because edges are narrow and all pixels that see an edge take further samples.
  static constexpr int kWide = 4, kNearSharp = 1;
  struct Around;

  double own_variance(int x, int y) const;
  bool on_lattice(int x, int y) const { return x % lattice_ == lattice_ / 2 && y % lattice_ == lattice_ / 2; }
  void look_around_mask();

  const CameraView& view_;
  const FrameOptions& options_;
  PartCounts first_;
  int first_half_;      ///< number of samples in the first half of the first samples
  double picture_ = 0;  ///< mean_to_white() of the first samples of the pixels of a lattice
  int lattice_;         ///< spacing of that lattice in pixels
  std::vector<std::uint8_t> looked_at_;
  ParallelArray<Pixel> pixels_;
};

}  // namespace tempolux
