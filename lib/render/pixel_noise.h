// lib/render/pixel_noise.h -- how many samples pixels need, by what their neighbours saw.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/core/parallel_array.h"
#include "lib/render/pixel_samples.h"

namespace tempolux {

/// Variance of what n, sum and sum of squares are of; 0 of one.
double sample_variance(double n, double sum, double square);
/// By what a pixel may err: e = pixel_error sqrt(l picture + (picture / 10)^2), l = min(level, picture); level is the
/// radiance around the pixel, picture the picture's mean (docs/pixels.md).
double allowed_error(double level, double picture, double pixel_error);
/// Samples of a part of a pixel's light that are to leave the pixel the error e, if sigma is the noise of one and
/// `cost` what it costs in rays (docs/pixels.md); 0 of e = 0.
double wanted_samples(double sigma, double cost, double error);
/// By how much smaller an `error` makes wanted_samples() leave as much noise of a light whose variance is `times` as
/// large: variance / samples ~ variance^(1 - k/2) error^k.
double error_for_variance(double times);

/// Samples of the parts lit and onward to a camera ray, at most. Samples of one place miss what differs between the
/// places of a pixel: edges of shadows, folds.
inline constexpr int kMostLit = 2, kMostOnward = 2;

/// Noise of a picture whose pixels have their first samples, and what more they need: docs/pixels.md derives it.
class PixelNoise {
 public:
  PixelNoise(const CameraView& view, const FrameOptions& options);

  /// Pixels whose first samples are needed: all, or of a masked frame those that say what a masked pixel needs: so it
  /// gets as many samples as in the whole frame. As FrameOptions::mask; empty: all.
  const std::vector<std::uint8_t>& looked_at() const { return looked_at_; }
  /// The first samples. Rays onward are the dearest part and often the least needed: half as many do to tell
  /// their noise, but where a filter is to do with the first samples alone.
  const PartCounts& first() const { return first_; }
  /// Which half first sample s belongs to.
  int half(int s) const { return s >= first_half_; }
  /// The two halves of a pixel's first samples, and the rays that their part `onward` took. Thread-safe for different
  /// pixels.
  void note(std::size_t pixel, const PixelSum& first, const PixelSum& second, std::uint64_t onward_rays);
  /// The first samples of all pixels are noted: what follows may be asked.
  void all_noted();
  /// Samples that a pixel is to have in all, by part; `times` as many as pixel_error asks for, within the limit.
  PartCounts wanted_at(int x, int y, double times) const;
  /// By what a pixel may err, around which there is radiance `level` [W/m^2/sr].
  double error_at(double level) const { return allowed_error(level, picture_, options_.pixel_error); }

 private:
  struct Pixel {
    double mean = 0;                     ///< of the first samples, mean of the channels; its square may be beyond float
    double lit_difference = 0;           ///< mean over half of them less that over the others
    double seen = 0, seen_variance = 0;  ///< of one of them, of part `own` but layer specular
    double mirrored_variance = 0;        ///< of that
    double onward = 0, onward_variance = 0;
    float onward_rays = 0;  ///< of one of them
  };
  static constexpr double kOnLattice = 4096;  ///< pixels, about: their mean errs by 1 % where they differ by 60 %
  // Pixels: one is judged by the 24 around it and by the 80; by 8 for what has edges, which are narrow: all that see
  // one pay for it.
  static constexpr int kNear = 2, kWide = 4, kNearSharp = 1;
  struct Around;

  template <class Body>
  void for_each_neighbour(int x, int y, int near, const Body& body) const;
  double own_variance(int x, int y) const;
  bool on_lattice(int x, int y) const { return x % lattice_ == lattice_ / 2 && y % lattice_ == lattice_ / 2; }
  void look_around_mask();

  const CameraView& view_;
  const FrameOptions& options_;
  PartCounts first_;
  int first_half_;      ///< samples in the first half of the first ones
  double picture_ = 0;  ///< mean of the first samples of the pixels of a lattice
  int lattice_;         ///< pixels from one of them to the next
  std::vector<std::uint8_t> looked_at_;
  ParallelArray<Pixel> pixels_;
};

}  // namespace tempolux
