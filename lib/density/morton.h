// lib/density/morton.h -- orders points along a space-filling curve, so that neighbours follow each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// An order of `points` in which successive points are close: a permutation of 0 .. size-1. Points are sorted by a
/// 32-bit Morton code within their bounding box. Each bit of the code halves the longest side of the cell, so a flat
/// set gets 2 x 16 bits. Points of equal code keep their order; points that are not finite come first. The same result
/// for any number of threads. Throws std::length_error for more than 2^32 - 1 points. Source: Morton, "A computer
/// oriented geodetic data base", IBM 1966.
std::vector<std::uint32_t> morton_order(std::span<const Vec3> points);

}  // namespace tempolux
