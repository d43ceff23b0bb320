// lib/gather/point_region.h -- the part of the surfaces that irradiance points are spread over: what cameras look at.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/core/vec.h"
#include "lib/light/aim.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// A triangle of a surface or, where it is large, a part of it.
struct TrianglePiece {
  std::uint32_t triangle = 0;
  std::array<Vec2, 3> corners{Vec2{0, 0}, Vec2{1, 0},
                              Vec2{0, 1}};  ///< weights of the triangle's second and third corner
  double area = 0;                          ///< m^2
  std::uint32_t spheres = 0;                ///< bit k: sphere k holds its middle
};

/// The pieces of a surface's triangles whose middles lie in some of up to 32 spheres (scene space), in the triangles'
/// order. A piece is a triangle, or a quarter of a piece that is longer than a quarter of the radius of a sphere that
/// holds part of it: the pieces' outline follows the spheres to that. Depends on the surface and the spheres alone.
std::vector<TrianglePiece> pieces_in(const Surface& surface, std::span<const AimSphere> spheres);

/// Of the spheres that hold what cameras see, those that irradiance points lie in: those with the most weight for the
/// area of surface in them, until they hold kHeld of all weight. `areas`: m^2 of surface in each; a sphere without
/// surface is left out. Elsewhere few gather rays end; where no point stands for their hit they go on, so that nothing
/// is lost (docs/methods/aim.md).
std::vector<AimSphere> spheres_with_points(std::span<const AimSphere> spheres, std::span<const double> areas);

}  // namespace tempolux
