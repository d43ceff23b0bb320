// lib/points/signed_density.h -- the change by dynamic photons at a place: signed irradiance, and influence.
#pragma once

#include <optional>
#include <span>

#include "formats/photons/photons.h"
#include "lib/core/random.h"
#include "lib/density/photon_index.h"
#include "lib/points/point_density.h"
#include "lib/points/reachable_area.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// DensityOptions::area_probes for dynamic maps. Eight probes estimate the area of a disc with a standard error of 15
/// %. A change is usually a hundredth of the light, so the error is .15 % of the light.
inline constexpr int kChangeProbes = 8;

/// Density estimates over the indirect photons of a dynamic map in given discs. The caller takes the radii from static
/// photons, because radii from few dynamic photons would be noisy. Reachability and area are those of the static scene,
/// as in PointDensity. Thread-safe.
class SignedDensity {
 public:
  /// shift: m, added to the photons' positions.
  SignedDensity(const Tracer& static_tracer, std::span<const formats::Photon> photons, const DensityOptions& options,
                Vec3d shift);

  struct Change {
    Rgbd irradiance{0.0};  ///< W/m^2: sum of flux with its sign / area
    /// W/m^2: sum over photons of the largest channel of |flux|, / area, so that gains and losses do not cancel.
    double influence = 0;
  };
  /// m: largest radius of a disc; by default PointDensity::kSparser times photon_reach().
  float max_radius() const { return options_.max_radius; }
  /// The reachable area of a disc in the static scene, which is the same for all maps of a segment.
  struct Area {
    bool known = false, whole = false;
    double inverse = 0;  ///< 1/m^2
  };
  /// The change by the photons in an ellipsoid around the position. `radius` [m] is its radius along the surface (0 or
  /// infinite: max_radius()); its radius along the normal is 1 / kFlattening of this. Empty if the ellipsoid holds no
  /// photon. `random`: as for PointDensity::estimate at the same place. The function measures `area` if it is needed
  /// and not known. A caller can pass one `area` for all maps of a segment, so that rays test the disc once.
  std::optional<Change> at(Vec3 position, Vec3 normal, float radius, const PathRandom& random, Area& area) const;
  /// An upper bound of Change::influence at a fraction of the cost: it also counts photons that do not reach the place,
  /// so no ray tests them. 0 if there are no photons.
  double most_influence(Vec3 position, Vec3 normal, float radius, const PathRandom& random, Area& area) const;

 private:
  /// Finds the photons within `radius`, and their area if there are any. Replaces a radius of 0 by the largest radius.
  void find(Vec3 position, Vec3 normal, float& radius, const PathRandom& random, Area& area,
            NeighbourList& found) const;

  DensityOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
};

}  // namespace tempolux
