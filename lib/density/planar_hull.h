// lib/density/planar_hull.h -- estimates the area of the region in which points of a plane lie, from their convex hull.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tempolux {

/// Collects points of the unit square with 16 bits per coordinate and keeps little more than the corners of their
/// convex hull. All arithmetic is in integers, so neither hull nor area depends on the order of the points.
class PlanarHull {
 public:
  /// Adds the point (u, v); both coordinates are clamped to [0, 1).
  void add(double u, double v);
  std::uint64_t count() const { return count_; }
  /// Area of the region, as a share of the unit square: the hull's area times (n + 1) / (n + 1 - corners), since the
  /// hull of n points is smaller than the region. Unbiased for points of a Poisson process over a convex region (Baldin
  /// and Reiss, "Unbiased estimation of the volume of a convex body", Stochastic Processes and their Applications 126,
  /// 2016). At most 1; 0 if all points lie on a line.
  double area() const;

 private:
  using Corner = std::array<std::int32_t, 2>;
  std::vector<Corner> corners() const;  ///< of the hull, counter-clockwise
  std::vector<Corner> points_;
  std::size_t room_ = 128;  ///< number of points at which points_ is reduced to the hull's corners
  std::uint64_t count_ = 0;
};

}  // namespace tempolux
