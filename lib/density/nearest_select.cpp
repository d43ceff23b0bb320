#include "lib/density/nearest_select.h"

#include <algorithm>

namespace tempolux {

std::size_t keep_nearest(CandidateList& list, std::size_t k, std::vector<std::uint64_t>& keys) {
  keys.resize(list.count);
  for (std::size_t i = 0; i < list.count; ++i) keys[i] = list.key(i);
  const auto last = keys.begin() + std::ptrdiff_t(k) - 1;
  std::nth_element(keys.begin(), last, keys.end());
  const std::uint64_t most = *last;
  std::size_t kept = 0, farthest = 0;
  for (std::size_t i = 0; i < list.count; ++i) {
    const std::uint64_t key = list.key(i);
    list.distance2[kept] = list.distance2[i];
    list.photon[kept] = list.photon[i];
    if (key == most) farthest = kept;
    kept += key <= most;
  }
  list.count = kept;
  return farthest;
}

}  // namespace tempolux
