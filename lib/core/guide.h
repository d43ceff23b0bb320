// lib/core/guide.h -- speeds up the search in a cumulative table.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace tempolux {

/// Guide table [Chen, Asau, "On generating random variates from an empirical distribution", AIIE Transactions 6, 1974]:
/// for N equal parts of [0, 1), the first index that a number in the part can have. Searching a large table touches
/// many cache lines, searching one part touches one.
template <std::uint32_t N>
class Guide {
 public:
  Guide() = default;
  /// `answer(u)`: the table's index for u in [0, 1), which must not decrease as u grows. `last`: the largest index.
  template <class Answer>
  Guide(const Answer& answer, std::uint32_t last) {
    for (std::uint32_t part = 0; part < N; ++part) first_[part] = std::uint32_t(answer(double(part) / N));
    first_[N] = last;
  }
  struct Range {
    std::uint32_t first, last;  ///< the index is in this range, both ends included
  };
  Range range(double u) const {
    const std::uint32_t part = std::min(std::uint32_t(u * N), N - 1);
    return {first_[part], first_[part + 1]};
  }

 private:
  std::array<std::uint32_t, N + 1> first_{};
};

}  // namespace tempolux
