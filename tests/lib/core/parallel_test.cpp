// Parallel loops: every index once, results in order, exceptions arrive, memory bounded.
#include "lib/core/parallel.h"
#include "lib/core/parallel_array.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <vector>

namespace tempolux {
namespace {

TEST(ParallelChunks, CoverEveryIndexOnceForAnyThreadCount) {
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    for (std::size_t count : {0u, 1u, 63u, 64u, 65u, 1000u}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_chunks(count, 64, [&](std::size_t first, std::size_t last) {
        EXPECT_EQ(first % 64, 0u);
        for (std::size_t i = first; i < last; ++i) ++visits[i];
      });
      for (const auto& n : visits) EXPECT_EQ(n.load(), 1);
    }
  }
}

TEST(ParallelOrdered, TakesInOrderWithBoundedResultsInFlight) {
  for (int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    std::atomic<int> alive{0}, most{0};
    struct Item {
      std::atomic<int>& alive;
      std::size_t index;
      ~Item() { --alive; }
    };
    std::size_t expected = 0;
    parallel_ordered(
        500, 8,
        [&](std::size_t i) -> std::shared_ptr<void> {
          const int now = ++alive;
          int seen = most.load();
          while (now > seen && !most.compare_exchange_weak(seen, now)) {}
          return std::shared_ptr<Item>(new Item{alive, i});
        },
        [&](std::size_t i, void* item) {
          EXPECT_EQ(i, expected++);
          EXPECT_EQ(static_cast<Item*>(item)->index, i);
        });
    EXPECT_EQ(expected, 500u);
    EXPECT_LE(most.load(), 8);
    EXPECT_EQ(alive.load(), 0);
  }
}

TEST(ParallelOrdered, AnExceptionReachesTheCaller) {
  EXPECT_THROW(parallel_ordered(
                   100, 4, [](std::size_t) { return std::shared_ptr<void>(); },
                   [](std::size_t i, void*) {
                     if (i == 50) throw std::runtime_error("disk full");
                   }),
               std::runtime_error);
}

TEST(ParallelArray, HasEveryValueMade) {
  struct Value {
    double number = 7;
    bool flag = true;
  };
  for (const std::size_t count : {0u, 1u, 1'000'000u}) {
    ParallelArray<Value> values(count);
    ASSERT_EQ(values.size(), count);
    std::size_t made = 0;
    for (const Value& value : std::span<Value>(values)) made += value.number == 7 && value.flag;
    EXPECT_EQ(made, count);
  }
}

}  // namespace
}  // namespace tempolux
