// lib/filter/rows.h -- processes the rows of a picture in parallel.
#pragma once

#include "lib/core/parallel.h"

namespace tempolux {

/// Calls body(y) for each row.
template <class Body>
void for_each_row(int height, const Body& body) {
  constexpr std::size_t kRows = 16;  // of a chunk
  parallel_chunks(std::size_t(height), kRows, [&](std::size_t first, std::size_t last) {
    for (int y = int(first); y < int(last); ++y) body(y);
  });
}

}  // namespace tempolux
