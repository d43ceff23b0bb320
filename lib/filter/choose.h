// lib/filter/choose.h -- filtered or raw? Each pixel's mixture has the least squared error that the halves of its samples find.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tempolux {

/// R, G and B of a layer, row after row.
using Colours = std::array<std::vector<float>, 3>;

/// A layer by each half of the samples alone: independent of each other.
struct Halves {
  Colours a, b;
};

/// The mixture of a raw layer and its filtered candidates that has the least squared error, by pixel.
///
/// With A, B the raw halves, f, g a candidate of A alone and of B alone, M = (A + B) / 2 and F = (f + g) / 2, unbiased estimates at a pixel are
///     of the squared error of F:   ((f - B)^2 + (g - A)^2) / 2 - (A - B)^2 / 2 - (f - g)^2 / 4
///     of the squared error of M:   (A - B)^2 / 4
///     of the covariance of both:   (f - g) (A - B) / 4.
/// Each is divided by the square of the light around plus a quarter of the pixel's own noise, summed over colours and averaged over pixels around of the
/// same kind (`kinds`: 1 inside surfaces, 0 at edges). A pixel's own noise lowers its weight alike in all three: a lone bright sample does not decide
/// for what is around it. The candidate of the least error is taken; shares of candidates are averaged likewise. Then that F counts by
/// w = (error of M - covariance) / (mean of (F - M)^2), from 0 to 1, and M by 1 - w. Rousselle, Knaus, Zwicker: Adaptive rendering with non-local means
/// filtering, 2012. Where both halves are equal M is the answer, to the bit if (A + B) / 2 is.
/// Pixels with a half that is not finite, or too bright for squares in float32, decide nothing: they are M, or the last candidate where M is not finite.
///
/// All planes have width * height elements; `candidates` is not empty. Thread-safe; the same result for any number of threads.
Colours choose(const Halves& raw, const std::vector<Halves>& candidates, const std::vector<std::uint8_t>& kinds, int width, int height);

}  // namespace tempolux
