// lib/filter/plane.h -- one number for each pixel, with a margin around the picture, so that windows need no tests at its borders.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "formats/large_pages.h"

namespace tempolux {

/// Pixels beyond the picture, as far as any window reaches. They hold T{}.
inline constexpr int kMargin = 8;

template <class T>
class PlaneT {
 public:
  PlaneT() = default;
  PlaneT(int width, int height)
      : stride_(std::size_t(width) + 2 * kMargin), height_(height) {
    const std::size_t count = stride_ * (std::size_t(height) + 2 * kMargin);
    data_.reserve(count);
    formats::prefer_large_pages(data_.data(), count * sizeof(T));
    data_.resize(count);
  }
  /// Pixel (0, y); y from -kMargin to height + kMargin - 1, columns likewise.
  T* row(int y) { return data_.data() + std::size_t(y + kMargin) * stride_ + kMargin; }
  const T* row(int y) const { return data_.data() + std::size_t(y + kMargin) * stride_ + kMargin; }
  T& at(int x, int y) { return row(y)[x]; }
  const T& at(int x, int y) const { return row(y)[x]; }
  bool empty() const { return data_.empty(); }
  /// Copies a picture's samples in, row by row.
  void take(const std::vector<T>& samples, int width) {
    for (int y = 0; y < height_; ++y) std::copy_n(samples.data() + std::size_t(y) * std::size_t(width), width, row(y));
  }

 private:
  std::size_t stride_ = 0;
  int height_ = 0;
  std::vector<T> data_;
};

using Plane = PlaneT<float>;

}  // namespace tempolux
