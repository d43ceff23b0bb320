// formats/float_bits.h -- what a float32 is, by its bits: the same in every floating-point mode.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tempolux::formats {

/// Neither infinite nor NaN.
inline bool is_finite(float x) { return (std::bit_cast<std::uint32_t>(x) & 0x7f800000u) != 0x7f800000u; }

/// Below zero, where denormal numbers count as zero too; -0 is not. NaN with a sign is.
inline bool is_negative(float x) { return std::bit_cast<std::uint32_t>(x) > 0x80000000u; }

/// +0 or -0, and no denormal number.
inline bool is_zero(float x) { return (std::bit_cast<std::uint32_t>(x) & 0x7fffffffu) == 0; }

inline bool is_finite(const std::array<float, 3>& v) { return is_finite(v[0]) && is_finite(v[1]) && is_finite(v[2]); }
inline bool is_negative(const std::array<float, 3>& v) {
  return is_negative(v[0]) || is_negative(v[1]) || is_negative(v[2]);
}

inline bool is_zero(const std::array<float, 3>& v) { return is_zero(v[0]) && is_zero(v[1]) && is_zero(v[2]); }

}  // namespace tempolux::formats
