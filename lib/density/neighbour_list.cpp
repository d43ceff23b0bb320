#include <algorithm>
#include <bit>

#include "lib/density/nearest_select.h"
#include "lib/density/photon_index.h"

namespace tempolux {
NeighbourList::Guess& NeighbourList::guess_for(const PhotonIndex& index, int k) {
  for (Guess& guess : guesses_)
    if (guess.index == &index && guess.k == k) return guess;
  Guess& guess = guesses_[oldest_guess_];
  oldest_guess_ = (oldest_guess_ + 1) % guesses_.size();
  return guess = {&index, k};
}

void NeighbourList::sort_by_distance() {
  if (count_ < 2) return;
  farthest_ = count_ - 1;
  keys_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) keys_[i] = distance_key(distance2_[i], photon_[i]);
  std::sort(keys_.begin(), keys_.end());
  for (std::size_t i = 0; i < count_; ++i) {
    distance2_[i] = std::bit_cast<float>(std::uint32_t(keys_[i] >> 32));
    photon_[i] = std::uint32_t(keys_[i]);
  }
}

}  // namespace tempolux
