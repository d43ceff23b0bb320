// lib/density/morton.h -- an order along a space-filling curve, so that neighbours follow each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// The order in which to visit `points` so that successive ones are close: a permutation of 0 .. size-1.
/// Sorted by a 32-bit Morton code within the points' bounding box; its bits go to the axes in proportion to
/// the box (each next bit halves the longest side of the cell), so a flat set gets 2 x 16 bits. Points of
/// equal code keep their order; points that are not finite come first. Same result for any number of threads.
/// Throws std::length_error beyond 2^32 - 1 points.
/// Source: Morton, "A computer oriented geodetic data base", IBM 1966.
std::vector<std::uint32_t> morton_order(std::span<const Vec3> points);

}  // namespace tempolux
