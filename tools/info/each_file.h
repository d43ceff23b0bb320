// tools/info/each_file.h -- reads several files at once.
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"

namespace tempolux::tools {

/// Calls read(file) for each file, in parallel, then take(file, result) in the order of the files. As in a loop, the
/// first file that cannot be read throws, and earlier ones have been taken. At most one result for each thread is in
/// memory.
template <class Read, class Take>
void each_file(const std::vector<std::string>& files, const Read& read, const Take& take) {
  struct Made {
    std::optional<decltype(read(files.front()))> result;
    std::exception_ptr error;
  };
  const auto make = [&](std::size_t i) -> std::shared_ptr<void> {
    auto made = std::make_shared<Made>();
    try {
      made->result.emplace(read(files[i]));
    } catch (...) { made->error = std::current_exception(); }
    return made;
  };
  parallel_ordered(files.size(), std::size_t(parallel_thread_count()), make, [&](std::size_t i, void* item) {
    Made& made = *static_cast<Made*>(item);
    if (made.error) std::rethrow_exception(made.error);
    take(files[i], std::move(*made.result));
  });
}

}  // namespace tempolux::tools
