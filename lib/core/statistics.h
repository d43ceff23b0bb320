// lib/core/statistics.h -- numbers that all decisions on samples share.
#pragma once

namespace tempolux {

/// A difference of this many standard errors counts as certain. Noise of a normal distribution exceeds three standard
/// errors once in 370 times.
inline constexpr double kCertain = 3;

/// Share of the samples that a mixture draws without its guide. Where the guide misleads, the pdf is still a quarter of
/// the pdf without a guide, so the variance is at most four times as large [defensive mixtures: Hesterberg,
/// Technometrics 37(2), 1995].
inline constexpr double kUnguidedShare = 0.25;

}  // namespace tempolux
