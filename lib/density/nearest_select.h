// lib/density/nearest_select.h -- private to lib/density: lists of photons, filled eight at a time, and selection.
#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tempolux {

/// For each mask of eight lanes: the numbers of the lanes whose bits are set, lowest first.
inline constexpr auto kCompressLanes = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (std::size_t mask = 0; mask < 256; ++mask) {
    std::size_t n = 0;
    for (std::uint8_t lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1) table[mask][n++] = lane;
  }
  return table;
}();

/// Number of places that a list needs after its last entry, because append() stores whole vectors.
inline constexpr std::size_t kListSlack = 8;

/// A number that sorts photons by squared distance (>= 0, not NaN), then by index.
inline std::uint64_t distance_key(float distance2, std::uint32_t photon) {
  return std::uint64_t(std::bit_cast<std::uint32_t>(distance2)) << 32 | photon;
}

/// A list of photons (index and squared distance) in two arrays that the caller owns.
struct CandidateList {
  float* distance2;
  std::uint32_t* photon;
  std::size_t count = 0;

  std::uint64_t key(std::size_t i) const { return distance_key(distance2[i], photon[i]); }

  /// Appends the lanes whose bits are set in `mask`.
  void append(__m256 d2, __m256i photons, unsigned mask) {
    const __m256i lanes =
        _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kCompressLanes[mask].data())));
    _mm256_storeu_ps(distance2 + count, _mm256_permutevar8x32_ps(d2, lanes));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(photon + count), _mm256_permutevar8x32_epi32(photons, lanes));
    count += std::size_t(std::popcount(mask));
  }
};

/// Keeps the k nearest entries (1 <= k <= count) by key(), in list order; returns the place of the farthest one. `keys`
/// is memory for the selection.
std::size_t keep_nearest(CandidateList& list, std::size_t k, std::vector<std::uint64_t>& keys);

}  // namespace tempolux
