#include "lib/density/parallel_select.h"

#include <gtest/gtest.h>

#include <random>

namespace tempolux {
namespace {

std::vector<std::uint32_t> shuffled(std::size_t count) {
  std::vector<std::uint32_t> values(count);
  std::iota(values.begin(), values.end(), 0u);
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  return values;
}

/// Chunks from one value to all values; the border at the start, in the middle and at the end.
TEST(ParallelPartition, PutsInFrontWhatIsBelow) {
  for (const std::size_t count : {0, 1, 2, 7, 1000, 4099})
    for (const std::size_t chunk : {1, 3, 64, 5000})
      for (const std::size_t border : {std::size_t(0), count / 3, count / 2, count}) {
        std::vector<std::uint32_t> values = shuffled(count);
        const auto below = [&](std::uint32_t v) { return v < border; };
        ASSERT_EQ(parallel_partition(std::span(values), chunk, below), border) << count << " " << chunk;
        ASSERT_TRUE(std::is_partitioned(values.begin(), values.end(), below)) << count << " " << chunk << " " << border;
        std::sort(values.begin(), values.end());
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(values[i], i);  // none lost, none twice
      }
}

/// Large enough that samples are taken: shuffled, ascending, descending, and with a misleading sample. The misleading
/// sample holds the smallest values only, so the wanted value lies far outside of it.
TEST(ParallelNthElement, IsTheNth) {
  constexpr std::size_t kCount = 400000;
  std::vector<std::uint32_t> up(kCount), down, lies(kCount);
  std::iota(up.begin(), up.end(), 0u);
  down.assign(up.rbegin(), up.rend());
  std::uint32_t smallest = 0, other = 1024;
  std::vector<bool> met(kCount);
  for (std::size_t i = 0; i < 1024; ++i) met[i * kCount / 1024] = true;
  for (std::size_t i = 0; i < kCount; ++i) lies[i] = met[i] ? smallest++ : other++;
  for (const auto& start : {shuffled(kCount), up, down, lies})
    for (const std::size_t n : {std::size_t(0), std::size_t(1000), kCount / 3, kCount / 2, kCount - 1}) {
      std::vector<std::uint32_t> values = start;
      parallel_nth_element(std::span(values), n, std::less<>());
      ASSERT_EQ(values[n], n);
      ASSERT_TRUE(std::all_of(values.begin(), values.begin() + std::ptrdiff_t(n), [&](std::uint32_t v) {
        return v < n;
      })) << n;
    }
}

}  // namespace
}  // namespace tempolux
