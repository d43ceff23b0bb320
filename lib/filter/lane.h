// lib/filter/lane.h -- the pixels of a row that are worked on together, one number each.
#pragma once

#include <array>
#include <cstddef>

namespace tempolux {

inline constexpr std::size_t kStrip = 64;   ///< pixels: their sums stay in the first-level cache
using Lane = std::array<float, kStrip>;

}  // namespace tempolux
