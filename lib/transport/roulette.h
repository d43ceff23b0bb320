// lib/transport/roulette.h -- whether a path goes on.
#pragma once

#include <algorithm>

#include "lib/core/vec.h"

namespace tempolux {

/// Russian roulette [Arvo and Kirk 1990]: a path of this weight goes on with probability p = min(most, largest
/// component), and its weight becomes weight / p, so that the mean stays. u in [0, 1) decides; most < 1 ends paths that
/// lose nothing. False if the path ends.
inline bool survives(Rgb& weight, float most, float u) {
  const float survival = std::min(most, max_component(weight));
  if (!(u < survival)) return false;
  weight *= 1 / survival;
  return true;
}

}  // namespace tempolux
