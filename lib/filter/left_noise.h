// lib/filter/left_noise.h -- how far a filtered frame is from the light that its samples estimate.
#pragma once

#include <array>
#include <vector>

#include "lib/filter/choose.h"
#include "lib/image/image.h"

namespace tempolux {

/// What is estimated of the squared error of a filtered picture, by pixel and colour [(W/m^2/sr)^2]. One pixel's value
/// may be far off; means over many pixels are meant. Empty: nothing was filtered.
struct LeftError {
  Colours whole;  ///< noise that is left, and blur; may be below 0
  Colours noise;  ///< noise alone
  Colours known;  ///< variance of the raw picture, as its halves know it
};

/// Adds up layers. With M the raw picture, G the filtered one, n and k half the differences of their halves, all of
/// them sums over layers, an unbiased estimate of (G - truth)^2 is
///     (G - M)^2 - n^2 + 2 k n   [Stein: Estimation of the mean of a multivariate normal distribution, 1981],
/// as n^2 is the variance of M and k n the covariance of G and M. k^2 is the variance of G.
class LeftNoise {
 public:
  /// Adds a layer: raw and filtered halves.
  void add(const Halves& raw, const Halves& filtered);
  LeftError error() const;

 private:
  Colours raw_, left_, change_;  ///< n, k and G - M
};

/// Writes the root mean square over pixels and colours of the error that is left, in W/m^2/sr and in sRGB codes, into
/// the frame's attributes tempolux:noise.*, in place of those of the raw frame (formats/frames/frames.md 3). It is the
/// mean of `whole`, or that of `noise` if it is larger: choose() takes what has the least `whole`, which makes that too
/// small, the more the fewer pixels hold most of the noise. Added is what halves do not know: they agree about a thing
/// smaller than a pixel that samples met or missed. It is the square of the noise that the raw frame says, by pixels
/// rendered twice, less one standard error, beyond the mean of `known`. The error in codes is the linear one times the
/// slope of the sRGB curve at the filtered value, 0 where that is clipped. The standard error is that of blocks of 32 x
/// 32 pixels: errors of near pixels are alike. Nothing filtered, or no R, G and B: the attributes are removed.
void tell_left_noise(const LeftError& error, Image& frame);

}  // namespace tempolux
