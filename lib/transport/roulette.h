// lib/transport/roulette.h -- Russian roulette.
#pragma once

#include <algorithm>

#include "lib/core/vec.h"

namespace tempolux {

/// Russian roulette [Arvo and Kirk 1990]: a path continues with probability p = min(most, largest component of weight),
/// and its weight becomes weight / p, so the expectation does not change. u in [0, 1) decides. With most < 1, paths
/// that lose no light end, too. Returns false, with the weight unchanged, if the path ends.
inline bool survives(Rgb& weight, float most, float u) {
  const float survival = std::min(most, max_component(weight));
  if (!(u < survival)) return false;
  weight *= 1 / survival;
  return true;
}

}  // namespace tempolux
