// lib/light/lanes.h -- eight floats at a time, as numbers of a Vec3T: one lane for each of eight points.
#pragma once

#include <immintrin.h>

#include "lib/core/vec.h"

namespace tempolux {

struct Lanes {
  static constexpr int kCount = 8;
  __m256 v;

  Lanes() = default;
  Lanes(__m256 lanes) : v(lanes) {}
  Lanes(float all) : v(_mm256_set1_ps(all)) {}
  static Lanes load(const float* eight) { return _mm256_load_ps(eight); }   ///< aligned to 32 bytes
  void store(float* eight) const { _mm256_store_ps(eight, v); }

  friend Lanes operator+(Lanes a, Lanes b) { return _mm256_add_ps(a.v, b.v); }
  friend Lanes operator-(Lanes a, Lanes b) { return _mm256_sub_ps(a.v, b.v); }
  friend Lanes operator*(Lanes a, Lanes b) { return _mm256_mul_ps(a.v, b.v); }
  friend Lanes operator/(Lanes a, Lanes b) { return _mm256_div_ps(a.v, b.v); }
  Lanes operator-() const { return _mm256_xor_ps(v, _mm256_set1_ps(-0.0f)); }
  /// All bits of a lane where it holds; none where one is NaN.
  friend Lanes operator<(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ); }
  friend Lanes operator>(Lanes a, Lanes b) { return _mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ); }
  friend Lanes operator&(Lanes a, Lanes b) { return _mm256_and_ps(a.v, b.v); }
};

inline Lanes sqrt(Lanes a) { return _mm256_sqrt_ps(a.v); }
inline Lanes min(Lanes a, Lanes b) { return _mm256_min_ps(a.v, b.v); }   ///< b if one is NaN
inline Lanes max(Lanes a, Lanes b) { return _mm256_max_ps(a.v, b.v); }
inline Lanes abs(Lanes a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
inline Lanes with_sign_of(Lanes size, Lanes sign) {
  return _mm256_or_ps(abs(size).v, _mm256_and_ps(sign.v, _mm256_set1_ps(-0.0f)));
}
/// Where the sign bit of `choice` is set b, else a.
inline Lanes choose(Lanes choice, Lanes a, Lanes b) { return _mm256_blendv_ps(a.v, b.v, choice.v); }
/// Lane i in bit i.
inline unsigned signs(Lanes a) { return unsigned(_mm256_movemask_ps(a.v)); }

/// Eight vectors as one of lanes, filled one by one: lanes that are not hold anything.
struct LaneVectors {
  alignas(32) float x[Lanes::kCount], y[Lanes::kCount], z[Lanes::kCount];
  void set(int lane, Vec3 a) { x[lane] = a.x, y[lane] = a.y, z[lane] = a.z; }
  Vec3 get(int lane) const { return {x[lane], y[lane], z[lane]}; }
  Vec3T<Lanes> load() const { return {Lanes::load(x), Lanes::load(y), Lanes::load(z)}; }
  void store(Vec3T<Lanes> a) { a.x.store(x), a.y.store(y), a.z.store(z); }
};

}  // namespace tempolux
