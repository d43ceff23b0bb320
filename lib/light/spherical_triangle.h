// lib/light/spherical_triangle.h -- samples directions inside a triangle seen from a point.
#pragma once

#include <array>

#include "lib/core/vec.h"

namespace tempolux {

/// Three corners on the unit sphere.
using SphericalTriangle = std::array<Vec3d, 3>;

/// Unit directions to three corners, from the vectors to them [m]. A zero vector gives a direction of length 0.
SphericalTriangle as_seen(Vec3 to0, Vec3 to1, Vec3 to2);

/// Draws a direction uniformly in the triangle of the given solid angle [sr]; u in [0, 1)^2. u.y = 0 gives corner 1,
/// (0, 1) corner 0, (1, 1) corner 2. Double precision, since thin triangles cancel most digits. [Arvo, "Stratified
/// Sampling of Spherical Triangles", SIGGRAPH 1995]
Vec3d sample_spherical_triangle(const SphericalTriangle& t, double solid_angle, Vec2 u);

}  // namespace tempolux
