// lib/core/guide.h -- speeds up the search in a cumulative table.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace tempolux {

/// A guide table [Chen, Asau, "On generating random variates from an empirical distribution", AIIE Transactions 6,
/// 1974] divides [0, 1) into N equal parts. For each part it stores the smallest index that a number in this part
/// leads to. A search over the whole of a large table touches many cache lines; a search within one part touches
/// about one.
template <std::uint32_t N>
class Guide {
 public:
  Guide() = default;
  /// `answer(u)`: the table's index for u in [0, 1); it must not decrease as u grows. `last`: the largest index.
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
