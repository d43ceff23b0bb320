// lib/core/statistics.h -- numbers that all decisions on samples share.
#pragma once

namespace tempolux {

/// A difference of this many standard errors counts as certain. A normally distributed number exceeds three standard
/// errors once in 370 times.
inline constexpr double kCertain = 3;

/// Share of the samples that a mixture draws without its guide. Where the guide misleads, the density is still a
/// quarter of the plain density, so the variance is at most four times as large [defensive mixtures: Hesterberg,
/// Technometrics 37(2), 1995].
inline constexpr double kUnguidedShare = 0.25;

}  // namespace tempolux
