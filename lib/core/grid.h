// lib/core/grid.h -- rounds numbers to a coarse grid.
#pragma once

#include <cmath>

namespace tempolux {

/// The number nearest to `number` > 0 on a grid with `steps` steps from each power of two to the next.
///
/// A pilot's estimate errs by some per cent from seed to seed. Numbers in recipes come from a grid that is coarser than
/// this error, so that an edit which the picture does not show rarely changes a recipe. A least product of work and
/// squared error, (W + a k)(E + e / k), is flat in k: a factor s off the best k costs at most (2 + s + 1 / s) / 4 of the
/// product, 1.03 for half a step of a whole power of two, s = 2^(1/2).
inline double nearest_on_grid(double number, int steps) {
  return std::exp2(std::round(std::log2(number) * steps) / steps);
}

}  // namespace tempolux
