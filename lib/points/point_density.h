// lib/points/point_density.h -- irradiance from photons where walls, edges and steps cut the disc of the estimate.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/core/random.h"
#include "lib/density/photon_index.h"
#include "lib/points/reachable_area.h"
#include "lib/irradcache/points.h"
#include "lib/trace/trace.h"

namespace tempolux {

struct DensityOptions {
  int neighbours = 50;                   ///< k
  float max_radius = 0;                  ///< m; 0: kSparser times photon_reach()
  int area_probes = 32;                  ///< probes that must arrive if the disc is not whole
  std::function<bool(Vec3)> where = {};  ///< places whose photons photon_reach() measures; empty: all
};

/// Irradiance at points by density estimation over one set of photons. Thread-safe.
///
///     E [W/m^2] = (flux of the reachable photons among the k-1 nearest) / (reachable area)
///
/// Distances are measured in the metric of an ellipsoid around the point, whose axis along the normal is a tenth of the
/// others. Only surfaces within 84 degrees of the point's plane count. The area is that of the reachable surface inside
/// the ellipsoid that touches the k-th photon. If fewer than k photons are within max_radius, all of them are summed,
/// and the area is that inside the ellipsoid of max_radius.
///
/// If light is uniform on the reachable surface, E is unbiased, whatever the light elsewhere is. Given the ellipsoid,
/// each of the k-1 photons is reachable with the probability (reachable light / all light in the ellipsoid), and
/// (k-1) / (all light in the ellipsoid) has the mean 1 (irradiance_estimate.h). This requires the same test (Reach) for
/// photons and for area. If only the area were cut, points at thin walls would be too bright; if only photons were left
/// out, points in corners would be too dark.
class PointDensity {
 public:
  /// The ratio of max_radius to photon_reach(). Where photons are 16 times as sparse as in the rest of the scene, k
  /// photons still lie within max_radius, because the area of the disc is 4^2 times as large.
  static constexpr float kSparser = 4;

  /// Uses the photons of these kinds (kind_bit), moved by `shift` [m] into scene space.
  PointDensity(const Tracer& tracer, std::span<const formats::Photon> photons, const DensityOptions& options,
               std::uint8_t kinds = kAllKinds, Vec3d shift = {});

  struct Estimate {
    Rgb irradiance{0.0f};  ///< W/m^2, >= 0
    Rgb noise{0.0f};   ///< W/m^2: the same sum with the flux of each photon times the sign of its path (path_signs.h)
    float radius = 0;  ///< m: the long half-axis of the ellipsoid; 0: no photon was found
  };
  /// The estimate at the position and normal of a point.
  Estimate estimate(const IrradiancePoint& point, const PathRandom& random) const;

 private:
  struct Disc {
    double radius = 0;         ///< m; 0: no photon was found
    std::size_t farthest = 0;  ///< index of the farthest photon found, which is not summed
  };
  Disc find(Vec3 position, Vec3 normal, NeighbourList& found) const;

  DensityOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
  std::vector<std::int8_t> signs_;  ///< by photon of the index
};

}  // namespace tempolux
