// lib/density/nearest_select.h -- private to lib/density: lists of photons, filled eight at a time, and selection.
#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tempolux {

/// For each 8-bit mask the numbers of the set lanes, lowest first.
inline constexpr auto kCompressLanes = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (std::size_t mask = 0; mask < 256; ++mask) {
    std::size_t n = 0;
    for (std::uint8_t lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1) table[mask][n++] = lane;
  }
  return table;
}();

/// Places that a list needs after its last entry, so that whole vectors can be stored.
inline constexpr std::size_t kListSlack = 8;

/// A list of (squared distance, photon) in two arrays that the caller owns.
struct CandidateList {
  float* distance2;
  std::uint32_t* photon;
  std::size_t count = 0;

  /// Sorts by squared distance, then by photon.
  std::uint64_t key(std::size_t i) const {
    return std::uint64_t(std::bit_cast<std::uint32_t>(distance2[i])) << 32 | photon[i];
  }

  /// Appends the lanes set in `mask`.
  void append(__m256 d2, __m256i photons, unsigned mask) {
    const __m256i lanes =
        _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kCompressLanes[mask].data())));
    _mm256_storeu_ps(distance2 + count, _mm256_permutevar8x32_ps(d2, lanes));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(photon + count), _mm256_permutevar8x32_epi32(photons, lanes));
    count += std::size_t(std::popcount(mask));
  }
};

/// Keeps the k nearest entries (1 <= k <= count) by key(), in list order; returns the place of the farthest one.
/// Distances must be >= 0 and not NaN. `keys`: memory.
std::size_t keep_nearest(CandidateList& list, std::size_t k, std::vector<std::uint64_t>& keys);

}  // namespace tempolux
