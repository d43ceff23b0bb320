// formats/exact_sum.h -- the exact sum of any number of float32 values.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace tempolux::formats {

/// Adds float32 values without rounding. One 64-bit counter per sign and exponent sums the 24-bit mantissas, so the
/// result does not depend on the order, and two sums can be joined. Holds up to 2^39 values.
class ExactSum {
 public:
  /// Adds a value, which must be finite.
  void add(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    bins_[bits >> 23] += (bits & 0x7fffff) | (std::uint32_t((bits & 0x7f800000) != 0) << 23);
  }
  void add(const ExactSum& other) {
    for (std::size_t e = 0; e < bins_.size(); ++e) bins_[e] += other.bins_[e];
  }
  /// The sum, rounded once to the nearest float64, ties to even (Python's math.fsum). +0 if empty.
  double rounded() const;

 private:
  std::array<std::int64_t, 512> bins_{};  ///< [256 s + e]: multiples of (-1)^s 2^(max(e, 1) - 150)
};

/// One exact sum per channel.
struct ExactRgbSum {
  std::array<ExactSum, 3> channels;

  /// Adds a value, which must be finite.
  void add(const std::array<float, 3>& value) {
    for (std::size_t c = 0; c < 3; ++c) channels[c].add(value[c]);
  }
  std::array<double, 3> rounded() const {
    return {channels[0].rounded(), channels[1].rounded(), channels[2].rounded()};
  }
};

}  // namespace tempolux::formats
