// lib/core/statistics.h -- numbers that all decisions on samples share.
#pragma once

#include <algorithm>
#include <span>

namespace tempolux {

/// A difference of this many standard errors counts as certain. Noise of a normal distribution exceeds three standard
/// errors once in 370 times.
inline constexpr double kCertain = 3;

/// Share of the samples that a mixture draws without its guide. Where the guide misleads, the pdf is still a quarter of
/// the pdf without a guide, so the variance is at most four times as large [defensive mixtures: Hesterberg,
/// Technometrics 37(2), 1995].
inline constexpr double kUnguidedShare = 0.25;

/// Upper median of at least one number: element size / 2 in ascending order. Reorders `values`, which hold no NaN.
inline double upper_median(std::span<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace tempolux
