// lib/light/spherical_triangle.h -- a triangle as seen from a point: directions in it.
#pragma once

#include <array>

#include "lib/core/vec.h"

namespace tempolux {

/// Three corners on the unit sphere.
using SphericalTriangle = std::array<Vec3d, 3>;

/// The corners' directions, of unit length; a corner at the point itself gives any direction.
SphericalTriangle as_seen(Vec3 to0, Vec3 to1, Vec3 to2);

/// Direction uniform in the triangle of the given solid angle [sr]; u in [0, 1)^2. u.y = 0 is corner 1, (0, 1) corner
/// 0, (1, 1) corner 2. In double: thin triangles cancel most digits. [Arvo, "Stratified Sampling of Spherical
/// Triangles", SIGGRAPH 1995]
Vec3d sample_spherical_triangle(const SphericalTriangle& t, double solid_angle, Vec2 u);
/// The u that gives the unit direction w; u.x is 0 at corner 1, where it does not matter.
Vec2 find_in_spherical_triangle(const SphericalTriangle& t, double solid_angle, Vec3d w);

/// A map of the unit square to itself whose density is bilinear between four values at its corners, so that what goes
/// about as these is about the same for each sample. [Hart, Pharr, Mueller, Lopes, McGuire & Shirley, "Practical
/// Product Sampling by Fitting and Composing Warps", CGF 39(4), 2020]
class BilinearWarp {
 public:
  /// Values at u = (0, 0), (1, 0), (0, 1), (1, 1), not negative; each counts as at least a hundredth of the largest, as
  /// what is 0 at all corners may not be so between them.
  explicit BilinearWarp(std::array<double, 4> values);
  Vec2 operator()(Vec2 u) const;
  double density(Vec2 u) const;  ///< of its result; 1 in the mean

 private:
  std::array<double, 4> w_;
};

}  // namespace tempolux
