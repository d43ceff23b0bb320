#include "lib/core/parallel.h"

#include <sched.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace tempolux {

struct ThreadLimit::State {
  tbb::global_control control;
  explicit State(int threads)
      : control(tbb::global_control::max_allowed_parallelism, std::size_t(std::max(1, threads))) {}
};

ThreadLimit::ThreadLimit(int threads) : state_(std::make_unique<State>(threads)) {}
ThreadLimit::~ThreadLimit() = default;

int usable_processor_count() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return std::max(1, CPU_COUNT(&set));
}

int parallel_thread_count() {
  const auto limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max(1, std::min(int(limit), tbb::this_task_arena::max_concurrency()));
}

void parallel_chunks(std::size_t count, std::size_t chunk_size,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t chunks = (count + chunk_size - 1) / chunk_size;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, chunks, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c)
          body(c * chunk_size, std::min(count, (c + 1) * chunk_size));
      },
      tbb::simple_partitioner());
}

void parallel_ordered(std::size_t chunk_count, std::size_t in_flight,
                      const std::function<std::shared_ptr<void>(std::size_t)>& make,
                      const std::function<void(std::size_t, void*)>& take) {
  // Results are stored here instead of in TBB's tokens: a pipeline that an exception cancels drops queued tokens
  // without destroying them. Results in flight are consecutive, so each has its own place.
  const std::size_t places = std::max<std::size_t>(1, in_flight);
  std::vector<std::shared_ptr<void>> made(places);
  std::size_t next = 0;
  tbb::parallel_pipeline(
      places, tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
                if (next == chunk_count) control.stop();
                return next < chunk_count ? next++ : next;
              }) & tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, [&](std::size_t i) {
                made[i % places] = make(i);
                return i;
              }) & tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order, [&](std::size_t i) {
                const std::shared_ptr<void> item = std::move(made[i % places]);
                take(i, item.get());
              }));
}

}  // namespace tempolux
