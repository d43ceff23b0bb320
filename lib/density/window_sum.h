// lib/density/window_sum.h -- an exact sum of float32 magnitudes in 72 bytes.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tempolux {

/// Adds |x| of float32 values exactly, so that the sum does not depend on their order. All finite float32 values are
/// multiples of 2^-149 below 2^128, so nine windows of 32 bits hold any value, and their 64-bit counters hold the sum
/// of 2^31 values. formats::ExactSum keeps signs and rounds to nearest, but takes 4 KiB, too much for each cell of a
/// grid.
class WindowSum {
 public:
  /// `value` must be finite. Works on bits, so denormal numbers count although the processor flushes them to zero.
  void add(float value) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) & 0x7fffffff, exponent = bits >> 23;
    const std::uint64_t mantissa = (bits & 0x7fffff) | (std::uint32_t(exponent != 0) << 23);
    const std::uint32_t unit = exponent > 0 ? exponent - 1 : 0;  // of the mantissa: 2^(unit - 149)
    const std::uint64_t shifted = mantissa << (unit & 31);
    windows_[unit >> 5] += shifted & 0xffffffff;
    windows_[(unit >> 5) + 1] += shifted >> 32;
  }
  /// The sum as a double: windows are added from the largest down and rounded after each, so equal sums give equal
  /// bits.
  double value() const {
    double sum = 0;
    for (int i = int(windows_.size()) - 1; i >= 0; --i)
      sum += std::ldexp(double(windows_[std::size_t(i)]), 32 * i - 149);
    return sum;
  }

 private:
  std::array<std::uint64_t, 9> windows_{};  ///< [i]: multiples of 2^(32 i - 149)
};

}  // namespace tempolux
