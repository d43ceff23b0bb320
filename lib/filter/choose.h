// lib/filter/choose.h -- filtered or raw? Each pixel's mixture has the least squared error that the halves of its
// samples find.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/filter/plane.h"

namespace tempolux {

/// R, G and B of a layer, row after row.
using Colours = std::array<std::vector<float>, 3>;

/// A layer by each half of the samples alone: uncorrelated. The layer is the mean of both.
struct Halves {
  Colours a, b;
};
/// Halved first: the sum may not be a number.
inline float mean_of(float a, float b) { return a / 2 + b / 2; }

/// What counts as around a pixel: pixels of the same kind within 7 x 7, and theirs again, so that near ones count more.
class Neighbourhood {
 public:
  /// kinds: by pixel 1 inside surfaces, 0 at edges.
  Neighbourhood(std::vector<std::uint8_t> kinds, int width, int height);
  /// Weighted means of values over what is around.
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

/// The mixture of a raw layer and its filtered candidates that has the least squared error, by pixel; in halves, of
/// which either is mixed of one half of the samples alone, with the same shares.
///
/// With A, B the raw halves, f, g a candidate of A alone and of B alone, M = (A + B) / 2 and F = (f + g) / 2, unbiased
/// estimates at a pixel are
///     of the squared error of M:   V = (A - B)^2 / 4
///     of the covariance of both:   C = (f - g) (A - B) / 4
///     of the squared error of F:   (F - M)^2 - V + 2 C   [Stein: Estimation of the mean of a multivariate normal
///     distribution, 1981].
/// Each is divided by the square of the light around (at least `dark`) plus a quarter of the pixel's own noise, summed
/// over colours and averaged over what is around. A pixel's own noise lowers its weight alike in all three: a lone
/// bright sample does not decide for what is around it. The candidate of the least error is taken; shares of candidates
/// are averaged likewise. Rousselle, Knaus, Zwicker: Adaptive rendering with non-local means filtering, 2012.
///
/// Then that F counts by w = (V - C + s) / (mean of (F - M)^2), from 0 to 1, and M by 1 - w. Inside surfaces s is the
/// standard error of V - C - (F - M)^2 if there is noise alone; at edges 0. Where both halves are equal M is the
/// answer, to the bit if (A + B) / 2 is. Pixels with a half that is not finite, or too bright for squares in float32,
/// decide nothing: they are M, or the last candidate where M is not finite.
///
/// All planes have as many elements as there are pixels; `candidates` is not empty. Thread-safe; the same result for
/// any number of threads.
Halves choose(const Halves& raw, const std::vector<Halves>& candidates, const Neighbourhood& around, float dark);

/// Light so dark that a layer is not looked at more closely: 2 % of its mean over the picture [W/m^2/sr].
float dark_of(const std::array<const std::vector<float>*, 3>& layer);

}  // namespace tempolux
