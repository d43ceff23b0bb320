// lib/density/planar_hull.h -- the area that points of a plane cover, from their convex hull.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tempolux {

/// Collects points of the unit square, kept to 16 bits per coordinate, and keeps of them little more than their convex
/// hull. All arithmetic is in integers, so neither hull nor area depend on the order of the points.
class PlanarHull {
 public:
  /// u, v are cut to [0, 1).
  void add(double u, double v);
  std::uint64_t count() const { return count_; }
  /// Area that the points were spread over evenly, as a share of the unit square: that of their hull times
  /// (n + 1) / (n + 1 - corners), as the hull of n points is too small by what its corners show. Without bias for
  /// points spread by a Poisson process over a convex shape (Baldin and Reiss, "Unbiased estimation of the volume of a
  /// convex body", Stochastic Processes and their Applications 126, 2016). At most 1; 0 if all points lie on a line.
  double area() const;

 private:
  using Corner = std::array<std::int32_t, 2>;
  std::vector<Corner> corners() const;  ///< of the hull, counter-clockwise
  std::vector<Corner> points_;
  std::size_t room_ = 128;  ///< points_ is cut down to the hull's corners when it has so many
  std::uint64_t count_ = 0;
};

}  // namespace tempolux
