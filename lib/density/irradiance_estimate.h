// lib/density/irradiance_estimate.h -- estimates irradiance from photons by density estimation.
#pragma once

#include "lib/density/photon_index.h"

namespace tempolux {

/// Ratio of the axes of the ellipsoid in which density estimates search photons. The short axis is along the normal, so
/// that photons on a parallel surface close by are left out.
inline constexpr float kFlattening = 10;
/// A photon or a surface counts at a place only if the cosine between its normal and the place's normal is above
/// kMinCos, so the angle is below 84 degrees. Photons on the other side of a thin wall therefore do not count. The
/// diagonal of the ellipsoid's axes makes about the same angle with the normal.
inline constexpr float kMinCos = 1 / kFlattening;

struct IrradianceOptions {
  int neighbours = 50;                                        ///< k, 2 .. kMaxNeighbours
  float max_radius = std::numeric_limits<float>::infinity();  ///< m, > 0; photons farther away are not used
};

struct IrradianceEstimate {
  Rgbd irradiance;          ///< W/m^2; negative where a dynamic map reduces the light
  float radius = 0;         ///< m, of the disc whose area the flux was divided by; 0: no estimate was possible
  std::uint32_t count = 0;  ///< number of photons in the sum
};

/// Irradiance at a surface point from the k nearest photons whose normals pass kMinCos, at distances in the metric of
/// the ellipsoid (PhotonQuery):
///
///     E  =  ( sum of flux over the k-1 nearest )  /  ( pi r_k^2 )      if r_min < r_k <= R
///     E  =  ( sum of flux over all within R )     /  ( pi R^2 )        if fewer than k are within R
///     E  =  ( sum of flux over all within r_min ) /  ( pi r_min^2 )    if r_k <= r_min
///
/// R is max_radius; r_min is the index's resolution, but at most R; r_k is the distance of the k-th photon. The rule is
/// unbiased for photons of uniform density. Reason: if a disc shrinks, (photons inside) / area is a martingale, and in
/// each of the three cases the disc stops at a size that depends only on photons outside the disc or on its edge. If
/// there are no photons, E = 0. If there are fewer than k photons and max_radius is infinite, no area is known, and E
/// and radius are 0. Sums are computed in double and in the index's order, so their bits do not depend on what
/// `scratch` was used for.
///
///     point    m, in the photons' space
///     normal   unit, on the side whose irradiance is estimated
///
/// Throws std::invalid_argument if an option is out of range. Source: Jensen, "Realistic Image Synthesis Using Photon
/// Mapping", 2001, ch. 7; k-1: Loftsgaarden & Quesenberry, Ann. Math. Stat. 36(3), 1965.
IrradianceEstimate estimate_irradiance(const PhotonIndex& index, Vec3 point, Vec3 normal,
                                       const IrradianceOptions& options, NeighbourList& scratch);

}  // namespace tempolux
