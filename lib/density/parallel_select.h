// lib/density/parallel_select.h -- std::nth_element with all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "lib/core/parallel.h"

namespace tempolux {

/// Moves the values for which below(value) is true to the front, in any order; returns their number. Each chunk is
/// partitioned separately; then values on the wrong side of the border are exchanged.
template <class T, class Below>
std::size_t parallel_partition(std::span<T> values, std::size_t chunk, const Below& below) {
  struct Run {
    std::size_t first, last;
    std::size_t length() const { return last - first; }
  };
  std::vector<Run> low((values.size() + chunk - 1) / chunk);  // by chunk: its values that belong to the front
  parallel_chunks(values.size(), chunk, [&](std::size_t first, std::size_t last) {
    const auto middle =
        std::partition(values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(last), below);
    low[first / chunk] = {first, std::size_t(middle - values.begin())};
  });
  std::size_t border = 0;
  for (const Run& run : low) border += run.length();
  // Runs to be exchanged, and their starts when they are counted one after the other.
  std::vector<Run> high_before, low_behind;
  std::vector<std::size_t> high_start{0}, low_start{0};
  const auto note = [](std::vector<Run>& runs, std::vector<std::size_t>& starts, std::size_t first, std::size_t last) {
    if (first >= last) return;
    runs.push_back({first, last});
    starts.push_back(starts.back() + last - first);
  };
  for (std::size_t i = 0; i < low.size(); ++i) {
    note(high_before, high_start, low[i].last, std::min({(i + 1) * chunk, values.size(), border}));
    note(low_behind, low_start, std::max(low[i].first, border), low[i].last);
  }
  parallel_chunks(high_start.back(), chunk, [&](std::size_t first, std::size_t last) {
    const auto run_of = [](const std::vector<std::size_t>& starts, std::size_t at) {
      return std::size_t(std::upper_bound(starts.begin(), starts.end(), at) - starts.begin()) - 1;
    };
    std::size_t h = run_of(high_start, first), l = run_of(low_start, first);
    while (first < last) {
      const std::size_t end = std::min({last, high_start[h + 1], low_start[l + 1]});
      const auto from = values.begin() + std::ptrdiff_t(high_before[h].first + first - high_start[h]);
      std::swap_ranges(from, from + std::ptrdiff_t(end - first),
                       values.begin() + std::ptrdiff_t(low_behind[l].first + first - low_start[l]));
      first = end;
      h += first == high_start[h + 1];
      l += first == low_start[l + 1];
    }
  });
  return border;
}

/// As std::nth_element(values.begin(), values.begin() + n, values.end(), less); `less` must be a strict order without
/// ties. A sample gives two values close below and above the wanted one; all threads partition by these values.
template <class T, class Less>
void parallel_nth_element(std::span<T> values, std::size_t n, const Less& less) {
  constexpr std::size_t kSample = 1 << 10, kMargin = kSample / 16,
                        kChunk = 1 << 15;  // 4 standard deviations of the rank of a sample's median
  if (values.size() >= 4 * kChunk) {
    std::vector<T> sample;
    for (std::size_t i = 0; i < kSample; ++i) sample.push_back(values[i * values.size() / kSample]);
    std::sort(sample.begin(), sample.end(), less);
    const std::size_t rank = n * kSample / values.size();
    const T low = sample[rank > kMargin ? rank - kMargin : 0], high = sample[std::min(rank + kMargin, kSample - 1)];
    const std::size_t first = parallel_partition(values, kChunk, [&](const T& v) { return less(v, low); });
    if (first > n) return parallel_nth_element(values.first(first), n, less);
    values = values.subspan(first);
    n -= first;
    const std::size_t last = parallel_partition(values, kChunk, [&](const T& v) { return less(v, high); });
    if (last <= n) return parallel_nth_element(values.subspan(last), n - last, less);
    values = values.first(last);
  }
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(n), values.end(), less);
}

}  // namespace tempolux
