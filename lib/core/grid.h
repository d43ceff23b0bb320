// lib/core/grid.h -- rounds numbers to a coarse grid.
#pragma once

#include <cmath>

namespace tempolux {

/// The number nearest to `number` > 0 on a grid with `steps` steps from each power of two to the next.
///
/// A pilot's estimate errs by some per cent from seed to seed. The steps of the grid are larger than this error, so an
/// edit that the picture does not show rarely changes a number. The rounding costs little. Let k be a number of rays
/// that work W + a k and squared error E + e / k depend on. Their product is least at one k; with s times this k the
/// product is at most (2 + s + 1 / s) / 4 times as large. A grid of powers of two has s = 2^(1/2) at most, which costs
/// 3 %.
inline double nearest_on_grid(double number, int steps) {
  return std::exp2(std::round(std::log2(number) * steps) / steps);
}

}  // namespace tempolux
