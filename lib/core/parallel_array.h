// lib/core/parallel_array.h -- an array of fixed size that all threads initialise.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

#include "formats/large_pages.h"
#include "lib/core/parallel.h"

namespace tempolux {

/// An array of `count` values T{}. All threads initialise it: the system clears a page of memory when it is first
/// written, and if one thread wrote all pages, the other threads would wait.
template <class T>
class ParallelArray {
 public:
  explicit ParallelArray(std::size_t count)
      : data_(static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{alignof(T)}))), count_(count) {
    static_assert(std::is_trivially_destructible_v<T>);
    formats::prefer_large_pages(data_.get(), count * sizeof(T));
    parallel_chunks(count, (std::size_t(4) << 20) / sizeof(T) + 1, [&](std::size_t first, std::size_t last) {
      std::uninitialized_value_construct(data_.get() + first, data_.get() + last);
    });
  }

  std::size_t size() const { return count_; }
  T* begin() { return data_.get(); }
  T* end() { return data_.get() + count_; }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }
  operator std::span<T>() { return {data_.get(), count_}; }

 private:
  struct Free {
    void operator()(T* data) const { ::operator delete (data, std::align_val_t{alignof(T)}); }
  };
  std::unique_ptr<T, Free> data_;
  std::size_t count_;
};

}  // namespace tempolux
