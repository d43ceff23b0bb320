// lib/core/guide.h -- where in a cumulative table to look for a number: a few entries, not all.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace tempolux {

/// Guide table [Chen, Asau, "On generating random variates from an empirical distribution", AIIE Transactions 6, 1974]:
/// for N even parts of [0, 1) the first answer that a number in it can have. Searching a large table touches many lines
/// of memory, a part of it one.
template <std::uint32_t N>
class Guide {
 public:
  Guide() = default;
  /// `answer(u)`: the index that the table has for u in [0, 1); never falls as u grows. `last`: the largest index.
  template <class Answer>
  Guide(const Answer& answer, std::uint32_t last) {
    for (std::uint32_t part = 0; part < N; ++part) first_[part] = std::uint32_t(answer(double(part) / N));
    first_[N] = last;
  }
  struct Range {
    std::uint32_t first, last;  ///< the answer is one of these, both included
  };
  Range range(double u) const {
    const std::uint32_t part = std::min(std::uint32_t(u * N), N - 1);
    return {first_[part], first_[part + 1]};
  }

 private:
  std::array<std::uint32_t, N + 1> first_{};
};

}  // namespace tempolux
