// lib/volume/majorants.h -- a grid of majorants (upper bounds of extinction), and the walk of a ray through its cells.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"

namespace tempolux {

/// Cells of equal size in a box of scene space, each with a majorant: an extinction [1/m] that no point of the cell
/// exceeds. With majorants that are frozen over a segment, each photon looks up the same places in every frame.
class MajorantGrid {
 public:
  static constexpr std::uint64_t kMostCells = std::uint64_t(1) << 21;

  MajorantGrid() = default;  ///< a grid without cells
  /// A grid of counts[0] x counts[1] x counts[2] cells whose majorants are 0. Throws std::invalid_argument for an empty
  /// box, a count below 1, or more than kMostCells.
  MajorantGrid(const Box3& box, const std::array<std::int32_t, 3>& counts);

  bool empty() const { return values_.empty(); }
  const Box3& box() const { return box_; }
  const std::array<std::int32_t, 3>& counts() const { return counts_; }
  const std::vector<float>& values() const { return values_; }  ///< 1/m; z varies fastest
  std::vector<float>& values() { return values_; }
  /// Majorant at a point; 0 outside.
  float at(Vec3 point) const {
    const std::size_t index = index_of(point);
    return index < values_.size() ? values_[index] : 0;
  }
  /// Index into values() of the cell that holds a point; the size of values() for a point outside.
  std::size_t index_of(Vec3 point) const;
  /// Box of a cell, m.
  Box3d cell(std::int32_t x, std::int32_t y, std::int32_t z) const;
  /// Raises majorants above 0 to at least `least` [1/m], so that rays have enough tentative collisions.
  void raise_to(float least);
  /// Mean length of a chord through the box [m]: 4 V / S for a convex body (Cauchy).
  float mean_chord() const;
  std::string hash() const;  ///< of box, counts and majorants

  friend class MajorantWalk;

 private:
  float plane(int axis, std::int32_t number) const {
    return number == counts_[std::size_t(axis)] ? box_.upper[axis]
                                                : box_.lower[axis] + float(number) * cell_size_[axis];
  }
  Box3 box_;
  std::array<std::int32_t, 3> counts_{};
  Vec3 cell_size_;
  std::vector<float> values_;
};

/// Visits the cells that a ray passes, in order (a digital differential analyser: Amanatides & Woo, Eurographics 1987).
/// The ray's pieces in the cells follow each other without gap or overlap, from the entry into the box to the exit, or
/// to `length` if that comes first.
class MajorantWalk {
 public:
  struct Piece {
    float begin, end;  ///< m along the ray
    float majorant;    ///< 1/m
  };
  /// `direction` is unit; length may be infinite.
  MajorantWalk(const MajorantGrid& grid, Vec3 origin, Vec3 direction, float length);
  /// The next piece, whose length may be 0; false at the end.
  bool next(Piece& piece);

 private:
  float crossing(int axis) const;  ///< distance at which the ray leaves the present cell along this axis
  const MajorantGrid* grid_ = nullptr;
  Vec3 origin_, inverse_;
  std::array<std::int32_t, 3> cell_{}, step_{};
  std::array<float, 3> leave_{};
  float begin_ = 0, end_ = 0;
  bool inside_ = false;
};

}  // namespace tempolux
