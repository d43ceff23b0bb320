// lib/core/parallel_threads.cpp -- parallel.h with threads of the standard library. Replaces parallel.cpp in builds
// with ThreadSanitizer, which reports false races in Debian's TBB.
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
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

void run_isolated(const std::function<void()>& body) { body(); }

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
  const std::size_t places = std::max<std::size_t>(1, in_flight);
  std::vector<std::shared_ptr<void>> made(places);
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next = 0, taken = 0;
  bool taking = false;
  std::atomic<bool> stop{false};
  const auto work = [&] {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [&] { return stop || next == chunk_count || next < taken + places; });
      if (stop || next == chunk_count) return;
      const std::size_t i = next++;
      lock.unlock();
      std::shared_ptr<void> item = make(i);
      lock.lock();
      made[i % places] = std::move(item);
      while (!taking && taken < next && made[taken % places]) {
        taking = true;
        item = std::move(made[taken % places]);
        lock.unlock();
        take(taken, item.get());
        item.reset();
        lock.lock();
        taking = false;
        ++taken;
        changed.notify_all();
      }
    }
  };
  by_all(
      [&] {
        try {
          work();
        } catch (...) {
          {
            const std::lock_guard lock(mutex);  // otherwise a thread that is about to wait could miss the signal
            stop = true;
          }
          changed.notify_all();
          throw;
        }
      },
      stop);
}

}  // namespace tempolux
