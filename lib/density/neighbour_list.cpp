#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/density/nearest_select.h"
#include "lib/density/photon_index.h"

namespace tempolux {
namespace {

/// If a bucket is larger than this, std::sort takes the place of insertion sort.
constexpr std::uint32_t kFullBucket = 16;

}  // namespace

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
  // Squared distances on a surface are uniformly distributed, so sorting them into one bucket per entry almost sorts
  // the list, and insertion sort finishes. Where the distances are not uniform a bucket fills up, and std::sort is
  // used.
  const CandidateList list{distance2_.data(), photon_.data(), count_};
  const float largest = *std::max_element(distance2_.begin(), distance2_.begin() + std::ptrdiff_t(count_));
  const float scale = float(count_) / largest;
  const bool even = std::isfinite(scale) && scale > 0;
  const auto bucket = [&](std::size_t i) { return even ? std::size_t(distance2_[i] * scale) : 0; };

  thread_local std::vector<std::uint32_t> bucket_end;
  bucket_end.assign(count_ + 2, 0);
  for (std::size_t i = 0; i < count_; ++i) ++bucket_end[bucket(i)];
  std::uint32_t sum = 0, fullest = 0;
  for (std::uint32_t& end : bucket_end) {
    fullest = std::max(fullest, end);
    end = sum += end;
  }
  keys_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) keys_[--bucket_end[bucket(i)]] = list.key(i);
  if (fullest > kFullBucket) std::sort(keys_.begin(), keys_.end());
  else
    for (std::size_t i = 1; i < count_; ++i) {
      const std::uint64_t k = keys_[i];
      std::size_t place = i;
      for (; place > 0 && keys_[place - 1] > k; --place) keys_[place] = keys_[place - 1];
      keys_[place] = k;
    }
  for (std::size_t i = 0; i < count_; ++i) {
    distance2_[i] = std::bit_cast<float>(std::uint32_t(keys_[i] >> 32));
    photon_[i] = std::uint32_t(keys_[i]);
  }
}

}  // namespace tempolux
