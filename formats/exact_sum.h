// formats/exact_sum.h -- the exact sum of any number of float32 values.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tempolux::formats {

/// Adds float32 values without error: one 64-bit counter per exponent takes the signed 24-bit mantissas, so
/// the sum has no order and two sums may be joined. Room for 2^39 values.
class ExactSum {
 public:
  /// `value` must be finite.
  void add(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t exponent = (bits >> 23) & 255;
    const std::int64_t mantissa = (bits & 0x7fffff) | (std::uint32_t(exponent != 0) << 23);
    const std::int64_t sign = -std::int64_t(bits >> 31);
    bins_[exponent] += (mantissa ^ sign) - sign;
  }
  void add(const ExactSum& other) {
    for (std::size_t e = 0; e < bins_.size(); ++e) bins_[e] += other.bins_[e];
  }
  /// The sum, rounded once to the nearest float64, ties to even (Python's math.fsum). +0 if empty.
  double rounded() const;

 private:
  std::array<std::int64_t, 256> bins_{};   ///< [e]: multiples of 2^(max(e, 1) - 150)
};

}  // namespace tempolux::formats
