// lib/points/point_region.h -- the part of the surfaces on which irradiance points are placed: what cameras see.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/light/aim.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// A triangle of a surface, or a part of a triangle.
struct TrianglePiece {
  std::uint32_t triangle = 0;
  /// Barycentric weights of the triangle's second and third vertex, at the piece's corners.
  std::array<Vec2, 3> corners{Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}};
  double area = 0;            ///< m^2
  std::uint32_t spheres = 0;  ///< bit k is 1 if the middle of the piece lies in sphere k
};

/// Cuts the triangles of a surface into pieces and returns the pieces whose middles lie in one of up to 32 spheres
/// (scene space), in the order of the triangles. At first a triangle is one piece. A piece that crosses the outline of
/// a sphere and is longer than a quarter of the sphere's radius is cut into four, down to 2^-20 of the triangle. So the
/// returned pieces follow the outlines of the spheres. The result depends only on the surface and the spheres.
std::vector<TrianglePiece> pieces_in(const Surface& surface, std::span<const AimSphere> spheres);

/// Chooses the spheres in which irradiance points are placed, among the spheres around what cameras see: those with the
/// most weight per area of surface, until the chosen spheres have the share kHeld of all weight. `areas`: m^2 of
/// surface in each sphere; a sphere without surface is not chosen. Few gather rays end in the other spheres. No point
/// represents their hits, so these rays continue, and no light is lost (docs/methods/aim.md).
std::vector<AimSphere> spheres_with_points(std::span<const AimSphere> spheres, std::span<const double> areas);

}  // namespace tempolux
