// lib/render/pixel_noise.h -- the number of samples that a pixel needs, by the noise of its neighbours.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/core/parallel_array.h"
#include "lib/render/pixel_samples.h"
#include "lib/render/pixels_around.h"

namespace tempolux {

/// Variance of n numbers with this sum and sum of squares, divided by n - 1; 0 for one number.
double sample_variance(double n, double sum, double square);
/// The error that a pixel may have [W/m^2/sr]: pixel_error sqrt(l picture + (picture / 10)^2), l = min(level, picture).
/// level: radiance around the pixel; picture: mean radiance of the picture (docs/pixels.md).
double allowed_error(double level, double picture, double pixel_error);
/// Number of samples of one part for a pixel that may have this error: 2.5 (sigma / (error sqrt(cost)))^k, k = 7/8.
/// sigma: standard deviation of one sample; cost: its cost in shadow rays (docs/pixels.md). 0 if the error is 0.
double wanted_samples(double sigma, double cost, double error);
/// x = (1 - k/2) / k: if all parts take f times their samples, the error of a frame changes by f^-x, by the same model.
double error_exponent();
/// Factor times^-x for `error`, with which wanted_samples() leaves the same noise if the variance is `times` as large:
/// variance / samples is proportional to variance^(1 - k/2) error^k.
double error_for_variance(double times);
/// r = 2 / k - 1: n stratified samples leave the variance of one sample times n^-r, by the same model.
double stratified_rate();
/// Factor times^(-1 / k) for `error`, with which wanted_samples() is `times` as large.
double error_for_samples(double times);

/// Noise of the first samples of a picture, and the number of samples that each pixel needs. docs/pixels.md derives
/// both.
class PixelNoise {
 public:
  /// Reach, in pixels, of the 80 pixels of wanted_at(): as far as a pixel's samples are noticed.
  static constexpr int kWide = 4;

  /// Both arguments must outlive this object.
  PixelNoise(const CameraView& view, const FrameOptions& options);

  /// Pixels whose first samples are needed, as FrameOptions::mask (empty: all). With a mask: its pixels, the pixels
  /// around them and a lattice, so that the pixels of the mask get as many samples as in the whole frame.
  const std::vector<std::uint8_t>& looked_at() const { return looked_at_; }
  /// Numbers of first samples. The part onward has half as many, because its samples cost most and often need no more.
  const PartCounts& first() const { return first_; }
  /// Stores the sums over the two halves of a pixel's first samples. onward_rays: cost of their part onward, in shadow
  /// rays. Thread-safe for different pixels.
  void note(std::size_t pixel, const PixelSum& first, const PixelSum& second, std::uint64_t onward_rays);
  /// Radiance of a pixel's first samples, mean of the channels [W/m^2/sr].
  double mean_at(std::size_t pixel) const { return pixels_[pixel].mean; }
  /// Sets the radiance of a pixel if note() got differences between two frames. Call after note().
  void set_level(std::size_t pixel, double mean) { pixels_[pixel].mean = mean; }
  /// Computes the radiance of the picture. Call after note() of all pixels and before wanted_at().
  void all_noted();
  /// Number of samples of each part that a pixel is to have in all: `times` as many as pixel_error asks for, at least
  /// first(), at most FrameOptions::adaptive_limit.
  PartCounts wanted_at(int x, int y, double times) const;
  /// Cost of samples of a pixel in shadow rays, by the first samples of the pixels around it.
  double cost_at(int x, int y, const PartCounts& samples) const;
  /// The error that a pixel may have if the radiance around it is `level` [W/m^2/sr].
  double error_at(double level) const { return allowed_error(level, picture_, options_.pixel_error); }

 private:
  struct Pixel {
    double mean = 0;                         ///< radiance, mean of the channels; a float could not hold its square
    double lit_difference = 0;               ///< of the part lit: mean of the first half minus mean of the second half
    double seen = 0, seen_variance = 0;      ///< mean and variance of one sample of the part own without layer specular
    double specular_variance = 0;            ///< variance of one sample of the part own in layer specular
    double onward = 0, onward_variance = 0;  ///< mean and variance of one sample of the part onward
    float onward_rays = 0;                   ///< cost of one sample of the part onward, in shadow rays
  };
  /// Approximate number of lattice pixels: their mean has an error of 1 % if single pixels differ by 60 %.
  static constexpr double kOnLattice = 4096;
  /// Reach, in pixels, of the 8 pixels of own_variance(). They are few because edges are narrow, and all pixels near an
  /// edge that they contain get further samples.
  static constexpr int kNearSharp = 1;
  struct Around;

  double own_variance(int x, int y) const;
  bool on_lattice(int x, int y) const { return x % lattice_ == lattice_ / 2 && y % lattice_ == lattice_ / 2; }
  void look_around_mask();

  const CameraView& view_;
  const FrameOptions& options_;
  PartCounts first_;
  int first_half_;      ///< number of samples in the first half of the first samples
  double picture_ = 0;  ///< mean_to_white() of the first samples of the pixels of a lattice
  double white_ = 0;    ///< radiance that is shown as white, by exposure_of() of the same pixels
  int lattice_;         ///< spacing of that lattice in pixels
  std::vector<std::uint8_t> looked_at_;
  ParallelArray<Pixel> pixels_;
};

}  // namespace tempolux
