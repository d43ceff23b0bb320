// lib/irradcache/record_cells.h -- the cells of a RecordStore's levels, for records.cpp and record_lists.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lib/core/random.h"
#include "lib/core/vec.h"

namespace tempolux {

inline constexpr std::size_t kFirstBuckets = 256;  ///< of a level; their number grows with the entries
/// Relative rounding error of distances in float: spheres are enlarged by this share.
inline constexpr double kSphereRounding = 1e-6;

/// Numbers of a cell along the axes.
struct Cell {
  std::int64_t x, y, z;
};

/// The cell that holds a place. `local` [m]: the place relative to the grid's origin; `inverse` [1/m]: 1 / edge of a
/// cell.
inline Cell cell_at(Vec3d local, double inverse) {
  // Cell numbers are clamped to 2^60, so records far outside the scene share one cell.
  const auto index = [&](double x) { return std::int64_t(std::floor(std::clamp(x * inverse, -0x1p60, 0x1p60))); };
  return {index(local.x), index(local.y), index(local.z)};
}

/// Calls body(cell) for each cell that a validity sphere around `local` [m] meets; `radius` in m, `inverse_cell` as for
/// cell_at().
template <class Body>
void for_each_cell(Vec3d local, float radius, double inverse_cell, const Body& body) {
  const double reach = double(radius) * (1 + kSphereRounding);
  const Cell low = cell_at(local - Vec3d{1, 1, 1} * reach, inverse_cell);
  const Cell high = cell_at(local + Vec3d{1, 1, 1} * reach, inverse_cell);
  const double width = 1 / inverse_cell;
  // Squared distance to a cell along one axis, if there are several cells.
  const auto beyond2 = [&](double centre, std::int64_t cell, std::int64_t first, std::int64_t last) {
    if (first == last) return 0.0;
    const double d = std::max({0.0, double(cell) * width - centre, centre - double(cell + 1) * width});
    return d * d;
  };
  for (std::int64_t x = low.x; x <= high.x; ++x)
    for (std::int64_t y = low.y; y <= high.y; ++y) {
      const double aside2 = beyond2(local.x, x, low.x, high.x) + beyond2(local.y, y, low.y, high.y);
      for (std::int64_t z = low.z; z <= high.z; ++z)
        if (aside2 + beyond2(local.z, z, low.z, high.z) <= reach * reach) body(Cell{x, y, z});
    }
}

/// The bucket of a cell, below `count`, which is a power of two.
inline std::size_t bucket_of(Cell c, std::size_t count) {
  const std::uint64_t h = std::uint64_t(c.x) * 0x9e3779b97f4a7c15ull + std::uint64_t(c.y) * 0xc2b2ae3d27d4eb4full +
                          std::uint64_t(c.z) * 0x165667b19e3779f9ull;
  return std::uint32_t(mix64(h)) & (count - 1);
}

}  // namespace tempolux
