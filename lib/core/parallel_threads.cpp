// lib/core/parallel_threads.cpp -- parallel.h with threads of the standard library. Replaces parallel.cpp in builds
// with ThreadSanitizer, which reports false races in Debian's TBB.
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

std::atomic<int> most_threads{0};  ///< 0: no limit

/// All threads call body(). The first exception sets `stop` and reaches the caller.
void by_all(const std::function<void()>& body, std::atomic<bool>& stop) {
  std::mutex mutex;
  std::exception_ptr first;
  const auto guarded = [&] {
    try {
      body();
    } catch (...) {
      stop = true;
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < parallel_thread_count(); ++i) others.emplace_back(guarded);
  guarded();
  for (std::thread& other : others) other.join();
  if (first) std::rethrow_exception(first);
}

}  // namespace

struct ThreadLimit::State {
  int before;
  explicit State(int threads) : before(most_threads.exchange(std::max(1, threads))) {}
  ~State() { most_threads = before; }
};

ThreadLimit::ThreadLimit(int threads) : state_(std::make_unique<State>(threads)) {}
ThreadLimit::~ThreadLimit() = default;

int usable_processor_count() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) != 0 ? 1 : std::max(1, CPU_COUNT(&set));
}

int parallel_thread_count() { return most_threads > 0 ? most_threads.load() : usable_processor_count(); }

void parallel_chunks(std::size_t count, std::size_t chunk_size,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  const auto work = [&] {
    for (std::size_t first; !stop && (first = next.fetch_add(chunk_size)) < count;)
      body(first, std::min(count, first + chunk_size));
  };
  if (count <= chunk_size) work();
  else by_all(work, stop);
}

void parallel_ordered(std::size_t chunk_count, std::size_t in_flight,
                      const std::function<std::shared_ptr<void>(std::size_t)>& make,
                      const std::function<void(std::size_t, void*)>& take) {
  if (in_flight < 2) {
    for (std::size_t i = 0; i < chunk_count; ++i) take(i, make(i).get());
    return;
  }
  // Results are made in waves. While threads make a wave, one of them takes the wave before.
  std::vector<std::shared_ptr<void>> made, ready;
  for (std::size_t first = 0; first < chunk_count || !ready.empty(); first += ready.size()) {
    std::size_t taken = first - ready.size();
    made.assign(std::min(in_flight / 2, chunk_count - first), nullptr);
    parallel_chunks(1 + made.size(), 1, [&](std::size_t job, std::size_t) {
      if (job > 0) made[job - 1] = make(first + job - 1);
      else
        for (std::shared_ptr<void>& result : ready) take(taken++, std::exchange(result, nullptr).get());
    });
    ready.swap(made);
  }
}

}  // namespace tempolux
