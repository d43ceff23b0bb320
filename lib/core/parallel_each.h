// lib/core/parallel_each.h -- parallel loops over single elements and over pixels (parallel.h).
#pragma once

#include <cstddef>
#include <vector>

#include "lib/core/parallel.h"

namespace tempolux {

/// Calls body(i) for each i < count. A thread takes chunk_size > 0 consecutive i at a time.
template <class Body>
void parallel_each(std::size_t count, std::size_t chunk_size, const Body& body) {
  parallel_chunks(count, chunk_size, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

/// Calls body(x, y, p) for each pixel of a picture; p = y * width + x. A thread takes 16 rows at a time.
template <class Body>
void parallel_pixels(int width, int height, const Body& body) {
  const auto columns = std::size_t(width);
  parallel_each(std::size_t(height), 16, [&](std::size_t y) {
    for (std::size_t x = 0, p = y * columns; x < columns; ++x, ++p) body(int(x), int(y), p);
  });
}

/// Calls body(i, found) for each i < count. The body appends any number of elements to `found`. Returns all elements in
/// the order of i.
template <class T, class Body>
std::vector<T> parallel_found(std::size_t count, std::size_t chunk_size, const Body& body) {
  std::vector<std::vector<T>> found((count + chunk_size - 1) / chunk_size);
  parallel_chunks(count, chunk_size, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i, found[first / chunk_size]);
  });
  std::vector<T> all;
  for (const std::vector<T>& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

/// Calls body(i, sum) for each i < count. The body adds to `sum`, which begins as Sum{} in each chunk. Returns the sum
/// of the chunks' sums, added in their order.
template <class Sum, class Body>
Sum parallel_sum(std::size_t count, std::size_t chunk_size, const Body& body) {
  std::vector<Sum> sums((count + chunk_size - 1) / chunk_size);
  parallel_chunks(count, chunk_size, [&](std::size_t first, std::size_t last) {
    Sum sum{};  // on the stack: neighbours in `sums` would share cache lines
    for (std::size_t i = first; i < last; ++i) body(i, sum);
    sums[first / chunk_size] = sum;
  });
  Sum all{};
  for (const Sum& sum : sums) all += sum;
  return all;
}

}  // namespace tempolux
