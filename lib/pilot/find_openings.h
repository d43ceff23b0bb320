// lib/pilot/find_openings.h -- finds the openings through which light of sun and sky reaches what cameras see.
#pragma once

#include <span>
#include <vector>

#include "formats/plan/view.h"
#include "lib/light/lights.h"

namespace tempolux {

/// The start of a light path from sun or sky.
struct DistantStart {
  Vec3d origin{}, travel{};  ///< world space, m; unit direction of flight
  double value2 = 0;         ///< squared contribution of the path to what cameras see, in any unit
  double density = 0;        ///< Aim::density() of the aim that drew the start
};

/// Fewest starts from which openings are found: two that choose each sphere, and as many that measure.
inline constexpr std::size_t kFewestStarts = 4 * formats::kMaxViewSpheres;

/// Spheres that photons of sun and sky should pass (Aim's openings), such as parts of a window, and their weights.
///
/// If starts are drawn with the density p in place of q, the variance of the light that cameras see changes by the
/// factor
///     V = sum_i x_i^2 q_i / p_i  /  sum_i x_i^2.
/// x_i is the contribution of path i. Half of the starts choose the spheres, greedily: cells of lattices with edges of
/// powers of two, from half of the scene's radius downwards, are compared by sum of x^2 q over squared size, of starts
/// that no chosen sphere has yet and whose lines pass the cell. A cell must hold more than 1 of n + 1 of these starts.
/// Sphere k gets the weight r_k sqrt(sum of x^2 q), which minimises V for spheres that do not overlap; it is rounded to
/// a power of two. The other half of the starts measures V for n = 32, 16, 8, 4, 2, 1: small cells follow the shape of
/// an opening, but if they hold few starts they miss parts of it. The least V wins. If it is above 1 / 1.25 the openings
/// gain too little, and there are none. Nor are there any with fewer than kFewestStarts.
///
/// `table`: of the paths, with its aim. `origin` [m]: world-space position of the scene space's origin.
std::vector<formats::ViewSphere> find_openings(std::span<const DistantStart> starts, const EmissionTable& table,
                                               Vec3d origin);

}  // namespace tempolux
