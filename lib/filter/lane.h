// lib/filter/lane.h -- numbers of the pixels that are processed together, for vector instructions.
#pragma once

#include <immintrin.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tempolux {

inline constexpr std::size_t kStrip = 64;  ///< pixels of a strip: their sums fit into the first-level cache
using Lane = std::array<float, kStrip>;

/// Eight pixels are a register of AVX2. The types are vector extensions of gcc and clang, which use two registers on
/// processors with shorter ones.
inline constexpr std::size_t kEight = 8;
using Float8 = float __attribute__((vector_size(4 * kEight)));
using Int8 = std::int32_t __attribute__((vector_size(4 * kEight)));  ///< results of comparisons: -1 true, 0 false

inline Float8 load8(const float* from) {
  Float8 values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
inline Int8 load8(const std::uint32_t* from) {
  Int8 values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
inline void store8(Float8 values, float* to) { std::memcpy(to, &values, sizeof values); }
/// The values where the comparison is true, else 0.
inline Float8 where(Int8 is, Float8 values) { return reinterpret_cast<Float8>(is & reinterpret_cast<Int8>(values)); }
/// a b + c, rounded once.
inline Float8 multiply_add(Float8 a, Float8 b, Float8 c) {
#ifdef __FMA__
  return _mm256_fmadd_ps(a, b, c);
#else
  for (std::size_t i = 0; i < kEight; ++i) c[i] = std::fma(a[i], b[i], c[i]);
  return c;
#endif
}
inline Float8 all8(float value) { return Float8{} + value; }
inline Float8 abs8(Float8 values) { return reinterpret_cast<Float8>(reinterpret_cast<Int8>(values) & 0x7fffffff); }

}  // namespace tempolux
