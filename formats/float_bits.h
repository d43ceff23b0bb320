// formats/float_bits.h -- classifies float32 numbers by their bits, with the same result in every floating-point
// mode.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tempolux::formats {

/// True if x is neither infinite nor NaN.
inline bool is_finite(float x) { return (std::bit_cast<std::uint32_t>(x) & 0x7f800000u) != 0x7f800000u; }

/// True if x is below 0; denormal numbers count as well, -0 does not. Also true for a NaN with a sign.
inline bool is_negative(float x) { return std::bit_cast<std::uint32_t>(x) > 0x80000000u; }

/// True for +0 and -0; false for denormal numbers.
inline bool is_zero(float x) { return (std::bit_cast<std::uint32_t>(x) & 0x7fffffffu) == 0; }

inline bool is_finite(const std::array<float, 3>& v) { return is_finite(v[0]) && is_finite(v[1]) && is_finite(v[2]); }
inline bool is_negative(const std::array<float, 3>& v) {
  return is_negative(v[0]) || is_negative(v[1]) || is_negative(v[2]);
}

inline bool is_zero(const std::array<float, 3>& v) { return is_zero(v[0]) && is_zero(v[1]) && is_zero(v[2]); }

}  // namespace tempolux::formats
