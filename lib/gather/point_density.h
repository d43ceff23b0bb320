// lib/gather/point_density.h -- irradiance from photons where walls, edges and steps cut the disc.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "lib/core/random.h"
#include "lib/density/photon_index.h"
#include "lib/gather/reachable_area.h"
#include "lib/irradcache/points.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct DensityOptions {
  int neighbours = 50;                   ///< k
  float max_radius = 0;                  ///< m; 0: kSparser times the photons' own (photon_reach)
  int area_probes = 32;                  ///< that must arrive where the disc is not whole
  std::function<bool(Vec3)> where = {};  ///< places whose photons say what their own radius is; none: all
};

/// Density estimates over one set of photons. Thread-safe.
///
///     E = sum of flux over those of the k-1 nearest that can be reached / area that can be reached
///
/// nearest and area: in the ellipsoid 1 : 1/10 about the point that touches the k-th photon (or of
/// max_radius, with all its photons, if it holds fewer), on surfaces within 84 degrees of the point's plane.
/// Where light is uniform on what can be reached, whatever it is beyond, E has no bias: given the ellipsoid,
/// each of the k-1 photons is one with probability (light that can be reached / all light in it), and (k-1) /
/// (all light in it) has the mean 1 (irradiance_estimate.h). For that the same test (Reach) must decide on
/// photons and on area: clipping the area alone gains light at thin walls, dropping photons alone loses it in
/// corners.
class PointDensity {
 public:
  /// Where light is up to 16 times as sparse as where photons lie, k of them are still found.
  static constexpr float kSparser = 4;

  /// Of the photons of these kinds (kind_bit), moved by `shift` [m] into the scene's space.
  PointDensity(const Tracer& tracer, std::span<const formats::Photon> photons, const DensityOptions& options,
               std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  /// Irradiance [W/m^2], >= 0; `radius` receives the half-axis of the ellipsoid, m, 0 if no photon is near.
  Rgb estimate(const IrradiancePoint& point, const PathRandom& random, float& radius) const;

 private:
  struct Disc {
    double radius = 0;         ///< m; 0: no photon is near
    std::size_t farthest = 0;  ///< of the photons found: not summed
  };
  Disc find(Vec3 position, Vec3 normal, NeighbourList& found) const;
  Rgb plain(Vec3 position, Vec3 normal, float& radius, NeighbourList& found) const;

  DensityOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
};

}  // namespace tempolux
