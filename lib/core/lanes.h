// lib/core/lanes.h -- a Vec3 in the lanes of a vector register, for the innermost loops. Operators of __m128 and
// __m256d work lane by lane; each lane rounds as a scalar does, so results have the same bits on every processor.
#pragma once

#include <immintrin.h>

#include "lib/core/vec.h"

namespace tempolux::lanes {

/// x, y, z, 0. Reads no byte behind z.
inline __m128 load(const Vec3& a) { return _mm_maskload_ps(&a.x, _mm_setr_epi32(-1, -1, -1, 0)); }
inline __m256d load_double(const Vec3& a) { return _mm256_cvtps_pd(load(a)); }
inline Vec3 to_vec(__m128 a) {
  alignas(16) float lane[4];
  _mm_store_ps(lane, a);
  return {lane[0], lane[1], lane[2]};
}
/// y, z, x.
inline __m128 rotate(__m128 a) { return _mm_permute_ps(a, _MM_SHUFFLE(3, 0, 2, 1)); }
inline __m256d rotate(__m256d a) { return _mm256_permute4x64_pd(a, _MM_SHUFFLE(3, 0, 2, 1)); }
template <class Lanes>
Lanes cross(Lanes a, Lanes b) {
  return rotate(a * rotate(b) - rotate(a) * b);
}
/// (x + y) + z of a . b, in all lanes.
inline __m128 dot(__m128 a, __m128 b) {
  const __m128 p = a * b, sum = _mm_permute_ps(p, 0x00) + _mm_permute_ps(p, 0x55);
  return sum + _mm_permute_ps(p, 0xaa);
}
/// Unit vector; the zero vector stays zero.
inline __m128 normalize(__m128 a) {
  const __m128 l = _mm_sqrt_ps(dot(a, a));
  return _mm_and_ps(a / l, _mm_cmp_ps(l, _mm_setzero_ps(), _CMP_GT_OQ));
}

}  // namespace tempolux::lanes
