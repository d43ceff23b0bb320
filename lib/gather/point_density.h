// lib/gather/point_density.h -- irradiance from photons where walls, edges and steps cut the disc of the estimate.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/density/photon_index.h"
#include "lib/gather/reachable_area.h"
#include "lib/irradcache/points.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct DensityOptions {
  int neighbours = 50;                   ///< k
  float max_radius = 0;                  ///< m; 0: kSparser times the photons' own radius (photon_reach)
  int area_probes = 32;                  ///< probes that must arrive if the disc is not whole
  std::function<bool(Vec3)> where = {};  ///< places whose photons determine the photons' own radius; empty: all
};

/// Density estimates over one set of photons. Thread-safe.
///
///     E [W/m^2] = (flux of the reachable photons among the k-1 nearest) / (reachable area)
///
/// Distances are measured by an ellipsoid around the point, whose axis along the normal is a tenth of the others. Only
/// surfaces within 84 degrees of the point's plane count. The area is measured inside the ellipsoid that touches the
/// k-th photon. If the ellipsoid of max_radius holds fewer than k photons, the sum is over all photons in it, and the
/// area is measured inside this ellipsoid.
///
/// If light is uniform on the reachable surface, E is unbiased, whatever the light elsewhere is. Given the ellipsoid,
/// each of the k-1 photons is reachable with the probability (reachable light / all light in the ellipsoid), and
/// (k-1) / (all light in it) has the mean 1 (irradiance_estimate.h). This requires the same test (Reach) for photons
/// and for area: clipping the area alone gains light at thin walls, and dropping photons alone loses it in corners.
class PointDensity {
 public:
  /// Where light is up to 16 times as sparse as the mean over the places with photons, k photons are still found.
  static constexpr float kSparser = 4;

  /// Uses the photons of these kinds (kind_bit), moved by `shift` [m] into scene space.
  PointDensity(const Tracer& tracer, std::span<const formats::Photon> photons, const DensityOptions& options,
               std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  /// Irradiance [W/m^2], >= 0. `radius` receives the long half-axis of the ellipsoid [m]; 0 if no photon was found.
  /// `noise` receives the same sum [W/m^2] with the flux of each photon times the random sign of its path
  /// (path_signs.h).
  Rgb estimate(const IrradiancePoint& point, const PathRandom& random, float& radius, Rgb* noise = nullptr) const;

 private:
  struct Disc {
    double radius = 0;         ///< m; 0: no photon was found
    std::size_t farthest = 0;  ///< index of the farthest photon found, which is not summed
  };
  Disc find(Vec3 position, Vec3 normal, NeighbourList& found) const;
  Rgb plain(Vec3 position, Vec3 normal, float& radius, NeighbourList& found) const;

  DensityOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
  std::vector<std::int8_t> signs_;  ///< by photon of the index
};

}  // namespace tempolux
