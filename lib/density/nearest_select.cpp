#include "lib/density/nearest_select.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace tempolux {
namespace {

/// Number of list entries <= bound. The places up to the next multiple of 8 must hold NaN.
std::size_t count_up_to(const CandidateList& list, float bound) {
  const __m256 limit = _mm256_set1_ps(bound);
  __m256i sum = _mm256_setzero_si256();
  for (std::size_t i = 0; i < list.count; i += 8)
    sum = _mm256_sub_epi32(sum,
                           _mm256_castps_si256(_mm256_cmp_ps(_mm256_loadu_ps(list.distance2 + i), limit, _CMP_LE_OQ)));
  __m128i half = _mm_add_epi32(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
  half = _mm_add_epi32(half, _mm_shuffle_epi32(half, 0x4e));
  half = _mm_add_epi32(half, _mm_shuffle_epi32(half, 0xb1));
  return std::size_t(_mm_cvtsi128_si32(half));
}

float largest(const CandidateList& list) {
  __m256 most = _mm256_setzero_ps();
  for (std::size_t i = 0; i < list.count; i += 8)  // max(NaN, b) is b
    most = _mm256_max_ps(_mm256_loadu_ps(list.distance2 + i), most);
  __m128 half = _mm_max_ps(_mm256_castps256_ps128(most), _mm256_extractf128_ps(most, 1));
  half = _mm_max_ps(half, _mm_movehl_ps(half, half));
  half = _mm_max_ss(half, _mm_movehdup_ps(half));
  return _mm_cvtss_f32(half);
}

struct Threshold {
  float value;
  std::size_t count;  ///< number of entries <= value; above k only if several entries equal the k-th
};

/// A value with exactly k entries up to it, if equal entries allow. Counting is fast, so the value is found by trial:
/// by interpolation first (squared distances on a surface are uniformly distributed), then, if that is slow, by
/// bisection over float bit patterns.
Threshold find_threshold(const CandidateList& list, std::size_t k) {
  std::uint32_t low = 0, high = std::bit_cast<std::uint32_t>(largest(list));  // bits; count(low) < k
  std::size_t low_count = 0, high_count = list.count;
  if (const std::size_t zeros = count_up_to(list, 0.0f); zeros >= k) return {0.0f, zeros};
  for (int round = 0; high_count > k && high - low > 1; ++round) {
    std::uint32_t guess = low + (high - low) / 2;
    if (round < 8) {
      const float a = std::bit_cast<float>(low), b = std::bit_cast<float>(high);
      const float t = (float(k - low_count) - 0.5f) / float(high_count - low_count);
      guess = std::clamp(std::bit_cast<std::uint32_t>(a + (b - a) * t), low + 1, high - 1);
    }
    const std::size_t count = count_up_to(list, std::bit_cast<float>(guess));
    if (count < k) {
      low = guess;
      low_count = count;
    } else {
      high = guess;
      high_count = count;
    }
  }
  return {std::bit_cast<float>(high), high_count};
}

/// Removes entries above the threshold.
void compact(CandidateList& list, float threshold) {
  const __m256 limit = _mm256_set1_ps(threshold);
  const std::size_t count = list.count;
  list.count = 0;
  for (std::size_t i = 0; i < count; i += 8) {
    const __m256 d2 = _mm256_loadu_ps(list.distance2 + i);
    const __m256i photons = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(list.photon + i));
    const int mask = _mm256_movemask_ps(_mm256_cmp_ps(d2, limit, _CMP_LE_OQ));
    list.append(d2, photons, unsigned(mask));
  }
}

/// `value` is the largest entry. Drops entries equal to it, highest photon numbers first, until k remain.
void drop_ties(CandidateList& list, float value, std::size_t k) {
  std::vector<std::uint32_t> ties;
  for (std::size_t i = 0; i < list.count; ++i)
    if (list.distance2[i] == value) ties.push_back(list.photon[i]);
  const auto last = ties.begin() + std::ptrdiff_t(ties.size() - (list.count - k) - 1);
  std::nth_element(ties.begin(), last, ties.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.count; ++i) {
    if (list.distance2[i] == value && list.photon[i] > *last) continue;
    list.distance2[kept] = list.distance2[i];
    list.photon[kept++] = list.photon[i];
  }
  list.count = kept;
}

std::size_t farthest(const CandidateList& list) {
  const float value = largest(list);
  std::size_t place = list.count;
  for (std::size_t i = 0; i < list.count; ++i)
    if (list.distance2[i] == value && (place == list.count || list.photon[i] > list.photon[place])) place = i;
  return place;
}

void pad_with_nan(CandidateList& list) {
  _mm256_storeu_ps(list.distance2 + list.count, _mm256_set1_ps(std::numeric_limits<float>::quiet_NaN()));
}

}  // namespace

std::size_t keep_nearest(CandidateList& list, std::size_t k) {
  pad_with_nan(list);
  if (list.count > k) {
    const Threshold threshold = find_threshold(list, k);
    compact(list, threshold.value);
    if (list.count > k) drop_ties(list, threshold.value, k);
    pad_with_nan(list);
  }
  return farthest(list);
}

}  // namespace tempolux
