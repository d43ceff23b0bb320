// lib/pilot/lattice_cell.h -- cells of lattices in world space, so that small movements of a scene keep them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <utility>
#include <vector>

#include "formats/plan/view.h"
#include "lib/core/vec.h"

namespace tempolux {

/// Radius of the sphere around a cube over the cube's edge: half of the diagonal is .866.
inline constexpr double kRadiusOfCell = 0.875;

/// A cube of the lattice whose edges are 2^level m.
struct LatticeCell {
  int level = 0;
  std::array<double, 3> index{};  ///< integers, which may exceed an int: the lowest corner is at index 2^level

  /// The cell that holds a place [m].
  static LatticeCell at(Vec3d place, int level) {
    const auto index = [&](double x) { return std::floor(std::ldexp(x, -level)); };
    return {level, {index(place.x), index(place.y), index(place.z)}};
  }
  double edge() const { return std::ldexp(1.0, level); }  ///< m
  /// The sphere around the cell, without weight.
  formats::ViewSphere sphere() const {
    formats::ViewSphere sphere{.radius = kRadiusOfCell * edge()};
    for (std::size_t axis = 0; axis < 3; ++axis) sphere.centre[axis] = (index[axis] + 0.5) * edge();
    return sphere;
  }
  auto operator<=>(const LatticeCell&) const = default;
};

/// Sorts spheres by place, so that their order does not depend on the way in which they were found.
inline void sort_by_place(std::vector<formats::ViewSphere>& spheres) {
  std::ranges::sort(spheres, {}, [](const formats::ViewSphere& s) { return std::pair(s.centre, s.radius); });
}

}  // namespace tempolux
