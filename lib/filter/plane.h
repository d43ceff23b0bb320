// lib/filter/plane.h -- one number per pixel. A margin around the picture makes tests at its borders unnecessary.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "formats/large_pages.h"

namespace tempolux {

/// Width of the margin in pixels: the longest reach of a window. The margin holds T{}.
inline constexpr int kMargin = 16;

template <class T>
class PlaneT {
 public:
  PlaneT() = default;
  /// Sets all pixels to T{}.
  PlaneT(int width, int height) : PlaneT(unset(width, height)) {
    for (int y = 0; y < height; ++y) std::fill_n(row(y), width, T{});
  }
  /// Sets the margin but not the pixels, for a plane that is written whole before it is read.
  static PlaneT unset(int width, int height) {
    PlaneT plane;
    plane.stride_ = std::size_t(width) + 2 * kMargin;
    plane.height_ = height;
    const std::size_t all = plane.stride_ * (std::size_t(height) + 2 * kMargin),
                      count = all + kMargin;  // eight pixels are read together from any position
    plane.data_ = std::make_unique_for_overwrite<T[]>(count);
    formats::prefer_large_pages(plane.data_.get(), count * sizeof(T));
    std::fill_n(plane.data_.get() + all, kMargin, T{});
    for (int y = -kMargin; y < height + kMargin; ++y) {
      T* row = plane.row(y) - kMargin;
      if (y < 0 || y >= height) std::fill_n(row, plane.stride_, T{});
      else {
        std::fill_n(row, kMargin, T{});
        std::fill_n(row + kMargin + width, kMargin, T{});
      }
    }
    return plane;
  }
  /// Pixel (0, y); y from -kMargin to height + kMargin - 1, columns likewise.
  T* row(int y) { return data_.get() + std::size_t(y + kMargin) * stride_ + kMargin; }
  const T* row(int y) const { return data_.get() + std::size_t(y + kMargin) * stride_ + kMargin; }
  T& at(int x, int y) { return row(y)[x]; }
  const T& at(int x, int y) const { return row(y)[x]; }
  /// row(y)[x] is row(0)[y * stride() + x].
  std::size_t stride() const { return stride_; }
  bool empty() const { return !data_; }
  /// Copies a picture's samples, row by row.
  void take(const std::vector<T>& samples, int width) {
    for (int y = 0; y < height_; ++y) std::copy_n(samples.data() + std::size_t(y) * std::size_t(width), width, row(y));
  }

 private:
  std::size_t stride_ = 0;
  int height_ = 0;
  std::unique_ptr<T[]> data_;
};

using Plane = PlaneT<float>;

/// The mean of `values` over the 3 x 3 pixels around (x, y) that count; 0 if none counts. counts: 1 or 0 by pixel,
/// where `values` is 0 as well.
inline float mean_of_nine(const Plane& values, const Plane& counts, int x, int y) {
  float sum = 0, count = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) sum += values.at(x + i, y + j), count += counts.at(x + i, y + j);
  return count > 0 ? sum / count : 0;
}

}  // namespace tempolux
