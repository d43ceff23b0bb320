// lib/filter/remaining_noise.h -- estimates the error that remains in a filtered frame.
#pragma once

#include <array>
#include <vector>

#include "lib/filter/choose.h"
#include "lib/image/image.h"

namespace tempolux {

/// Estimates of a filtered picture's squared error, by pixel and colour [(W/m^2/sr)^2]. The estimate of one pixel is
/// very noisy; only means over many pixels are meaningful. Empty: nothing was filtered.
struct RemainingError {
  Colours whole;  ///< remaining noise and blur; may be negative
  Colours noise;  ///< remaining noise alone
};

/// Sums the error over layers. Let M be the raw picture, G the filtered one, and n and k half the differences of their
/// halves, all of them sums over layers. An unbiased estimate of (G - truth)^2 is
///     (G - M)^2 - n^2 + 2 k n   [Stein: Estimation of the mean of a multivariate normal distribution, 1981],
/// because n^2 estimates the variance of M and k n the covariance of G and M. k^2 estimates the variance of G.
class RemainingNoise {
 public:
  /// Adds a layer: raw and filtered halves.
  void add(const Halves& raw, const Halves& filtered);
  RemainingError error() const;

 private:
  Colours raw_, filtered_, change_;  ///< n, k and G - M
};

/// Writes the root mean square of the remaining error over pixels and colours, in W/m^2/sr and in sRGB codes, to the
/// frame's attributes tempolux:noise.*, in place of the raw frame's (formats/frames/frames.md 3); and that of each
/// layer with a channel LAYER.noise, which holds half the difference of the filtered halves.
///
/// The squared error is the mean of `noise`, or of `whole` if that is larger: choose() takes the candidate with the
/// least `whole`, so its `whole` is too small, most of all if few pixels hold most of the noise. Layers have no
/// `whole`.
///
/// The error in codes is the difference of the sRGB codes, clipped at 0 and 255, of the filtered value and of the value
/// without the error.
/// - The sign of the error that `whole` estimates is unknown, so the mean over both signs is taken.
/// - Noise |k| is subtracted. If it is not small compared to the light, a few bright samples made most of the value, so
///   the true value is smaller. Example: samples that find light L or nothing. A pixel that found L has |k| = L, and
///   its error is c(L) - c(0).
/// The standard error comes from blocks of 32 x 32 pixels, because errors of neighbouring pixels are correlated.
///
/// If nothing was filtered or R, G and B are missing, the attributes are removed.
void write_remaining_noise(const RemainingError& error, Image& frame);

}  // namespace tempolux
