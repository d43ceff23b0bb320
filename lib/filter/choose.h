// lib/filter/choose.h -- mixes the raw and the filtered light of each pixel for the least squared error, which the
// halves of the samples estimate.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/filter/plane.h"

namespace tempolux {

/// R, G and B of a layer, row after row.
using Colours = std::array<std::vector<float>, 3>;

/// A layer from each half of the samples alone, with uncorrelated noise.
struct Halves {
  Colours a, b;
  /// Pixels in which the renderer has confirmed an outlier as light: the difference of their halves is no noise.
  std::vector<std::size_t> confirmed{};
};
/// (a + b) / 2; each is halved first, because a + b may overflow.
inline float mean_of(float a, float b) { return a / 2 + b / 2; }

/// Weighted means around a pixel: a box filter of 7 x 7 pixels, applied twice, so that close pixels have more weight.
/// Only pixels of the same kind count. A pixel is either inside a surface or at an edge.
class Neighbourhood {
 public:
  /// `kinds`, by pixel: 1 inside surfaces, 0 at edges.
  Neighbourhood(std::vector<std::uint8_t> kinds, int width, int height);
  /// Weighted mean of `values` over each pixel's neighbourhood.
  Plane mean(const Plane& values) const;
  std::size_t kind(std::size_t pixel) const { return kinds_[pixel]; }
  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t count() const { return kinds_.size(); }

 private:
  Plane sums(const Plane& values) const;

  std::vector<std::uint8_t> kinds_;
  int width_, height_;
  Plane share_;  ///< 1 / number of pixels of the kind within 7 x 7
};

/// R, G and B of a picture, row after row.
using PicturePlanes = std::array<const std::vector<float>*, 3>;

/// The light up to which a pixel counts as dark: 2 % of the picture's mean [W/m^2/sr].
float dark_of(const PicturePlanes& picture);

/// The light of the picture, all layers together. Errors of a layer are divided by this light.
struct PictureLight {
  /// m + max(0, own - m) / 4 + dark [W/m^2/sr]. own is the light of the pixel, m the mean light of 3 x 3 pixels; both
  /// are means over the channels. The second term makes the divisor of a bright pixel larger than m, so that its error
  /// does not dominate the mean over its neighbourhood.
  Plane level;
  float dark;  ///< dark_of() the whole picture
  /// `picture`: the sum of all layers of the picture, or of a part of it.
  PictureLight(const PicturePlanes& picture, int width, int height, float dark_light);
};

/// Mixes a raw layer and its filtered candidates for the least squared error at each pixel. Each half of the result is
/// mixed from one half of the samples alone; the shares are the same in both halves.
///
/// A and B are the raw halves; f is a candidate made from A alone, and g the same candidate made from B alone. M = (A
/// + B) / 2 and F = (f + g) / 2. Unbiased estimates at a pixel are
///     the squared error of M:   V = (A - B)^2 / 4
///     the covariance of both:   C = (f - g) (A - B) / 4
///     the squared error of F:   (F - M)^2 - V + 2 C   [Stein: Estimation of the mean of a multivariate normal
///     distribution, 1981].
/// Each estimate is summed over colours, divided by the square of the picture's light at the pixel (PictureLight), and
/// averaged over the neighbourhood. Errors thus count as they are seen: more in a dark pixel than in a bright one.
///
/// 1. At each pixel the candidate with the least error is taken. The shares of the candidates are then averaged over
///    the neighbourhood [Rousselle, Knaus, Zwicker: Adaptive rendering with non-local means filtering, 2012].
/// 2. The result is w F + (1 - w) M with w = (V - C + s) / (F - M)^2, clamped to [0, 1], all terms being means over the
///    neighbourhood. Inside surfaces s is the standard error that V - C - (F - M)^2 has if A and B differ by noise
///    alone; at edges s = 0.
/// 3. The light that was taken from pixels is given to the filtered pixels around them, in proportion to w times the
///    result. The sum of the layer therefore stays the same as in M.
///
/// If both halves are equal all over a neighbourhood, the result is M, to the bit if (A + B) / 2 is. A pixel with a
/// half that is not finite, or above kLargestLight, enters no estimate; its result is M, or the last candidate if M is
/// not finite. All planes have one element per pixel; `candidates` is not empty. Thread-safe; the same result for any
/// number of threads.
Halves choose(const Halves& raw, const std::vector<Halves>& candidates, const Neighbourhood& around,
              const PictureLight& picture);

}  // namespace tempolux
