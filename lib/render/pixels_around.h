// lib/render/pixels_around.h -- the pixels around a pixel.
#pragma once

#include <algorithm>
#include <cstddef>

namespace tempolux {

/// Reach, in columns and rows, of the 24 pixels around a pixel from which its noise and its outliers are judged.
inline constexpr int kNearPixels = 2;

/// Calls body(pixel, i, j) for the pixels (i, j) of the picture at most `reach` columns and rows away from (x, y), row
/// by row, without (x, y) itself. `pixel` is j * width + i.
template <class Body>
void for_each_around(int width, int height, int x, int y, int reach, const Body& body) {
  for (int j = std::max(0, y - reach); j <= std::min(height - 1, y + reach); ++j)
    for (int i = std::max(0, x - reach); i <= std::min(width - 1, x + reach); ++i)
      if (i != x || j != y) body(std::size_t(j) * std::size_t(width) + std::size_t(i), i, j);
}

}  // namespace tempolux
