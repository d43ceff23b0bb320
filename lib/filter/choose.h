// lib/filter/choose.h -- filtered or raw? Each pixel's mixture has the least squared error that the halves of its samples find.
#pragma once

#include <array>
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
/// Each is divided by the square of the light around, summed over colours and averaged over the pixels around. The candidate of the least error
/// is taken; the shares of the candidates are averaged likewise. Then that F counts by w = (error of M - covariance) / (mean of (F - M)^2), from 0
/// to 1, and M by 1 - w. Rousselle, Knaus, Zwicker 2012; algorithms.md 13.
/// Where all is equal in both halves M is the answer.
Colours choose(const Halves& raw, const std::vector<Halves>& candidates, int width, int height);

}  // namespace tempolux
