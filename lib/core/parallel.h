// lib/core/parallel.h -- deterministic parallel loops. No other file of lib and tools uses TBB. parallel_threads.cpp
// does the same without TBB.
//
// Work is cut into chunks by count, never by the number of threads, and results are joined in chunk order: the same
// numbers for any --threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace tempolux {

/// While an object lives, at most `threads` threads work in parallel loops (also in Embree's and OpenEXR's).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Processors this process may use (its CPU set, not the machine's count); at least 1.
int usable_processor_count();
/// Number of threads of a parallel loop that starts now. Memory may depend on it, results must not.
int parallel_thread_count();

/// Calls body(first, last) for each chunk [first, last) of [0, count); chunks start at multiples of
/// chunk_size. Exceptions reach the caller. chunk_size > 0.
void parallel_chunks(std::size_t count, std::size_t chunk_size,
                     const std::function<void(std::size_t first, std::size_t last)>& body);

/// Calls make(i) for each i < chunk_count, in parallel and in any order, then take(i, result) one at a time, in the
/// order of i. At most `in_flight` results exist at once, so memory does not grow with the count. `take` gets the
/// pointer that `make` returned; the result is freed afterwards.
void parallel_ordered(std::size_t chunk_count, std::size_t in_flight,
                      const std::function<std::shared_ptr<void>(std::size_t)>& make,
                      const std::function<void(std::size_t, void*)>& take);

}  // namespace tempolux
