// lib/density/irradiance_estimate.h -- irradiance from photons by density estimation.
#pragma once

#include <span>

#include "lib/density/photon_index.h"

namespace tempolux {

struct IrradianceOptions {
  int neighbours = 50;                                        ///< k, 2 .. kMaxNeighbours
  float max_radius = std::numeric_limits<float>::infinity();  ///< m, > 0; photons beyond it are not used
  float min_radius = 0;   ///< m; the estimate never looks closer than this or the index's resolution
  float min_cos = 0.1f;   ///< of the photon's and the point's normal: keeps a thin wall's sides apart
  float flattening = 10;  ///< ellipsoid 1 : 1/flattening, thin along the normal (photon_index.h)
  std::uint8_t kinds = kAllKinds;
};

struct IrradianceEstimate {
  Rgbd irradiance;          ///< W/m^2; negative where a dynamic map takes light away
  float radius = 0;         ///< m, of the disc that was divided by; 0: no estimate was possible
  std::uint32_t count = 0;  ///< photons summed
};

/// Irradiance at a surface point from the k nearest photons that pass the options' tests:
///
///     E  =  ( sum of flux over the k-1 nearest )  /  ( pi r_k^2 )      if r_min < r_k <= R
///     E  =  ( sum of flux over all within R )     /  ( pi R^2 )        if fewer than k are within R
///     E  =  ( sum of flux over all within r_min ) /  ( pi r_min^2 )    if r_k <= r_min
///
/// R is max_radius; r_min the larger of min_radius and the index's resolution, but at most R. The whole rule
/// has no bias where photons are spread evenly: in a shrinking disc (photons inside) / area is a martingale,
/// and each of the three cases stops it at a time that depends only on what was seen so far.
/// Without photons, E = 0. With fewer than k and no max_radius there is no area to divide by: E = 0, radius 0
/// (the same if everything is in one point at the origin and min_radius is 0). Sums are in double,
/// in the index's order: the same bits whatever `scratch` was used for.
///
///   point    m, the photons' space
///   normal   unit length, on the side whose irradiance is wanted
///
/// Throws std::invalid_argument if an option is out of range.
/// Source: Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001, ch. 7; k-1: Loftsgaarden &
/// Quesenberry, Ann. Math. Stat. 36(3), 1965.
IrradianceEstimate estimate_irradiance(const PhotonIndex& index, Vec3 point, Vec3 normal,
                                       const IrradianceOptions& options, NeighbourList& scratch);

/// The estimate with one radius everywhere: sum over all photons within max_radius / (pi max_radius^2).
/// neighbours and min_radius are not read; max_radius must be finite.
IrradianceEstimate estimate_irradiance_fixed(const PhotonIndex& index, Vec3 point, Vec3 normal,
                                             const IrradianceOptions& options, NeighbourList& scratch);

/// estimate_irradiance for many points, given in any order: visits them along a space-filling curve, in
/// parallel, and writes results[i] for points[i]. The three spans have one length.
void estimate_irradiances(const PhotonIndex& index, std::span<const Vec3> points, std::span<const Vec3> normals,
                          const IrradianceOptions& options, std::span<IrradianceEstimate> results);

}  // namespace tempolux
