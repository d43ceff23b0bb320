// lib/gather/signed_density.h -- what dynamic photons change at a place: irradiance with sign, and influence.
#pragma once

#include <optional>
#include <span>

#include "formats/photons/photons.h"
#include "lib/core/random.h"
#include "lib/density/photon_index.h"
#include "lib/gather/point_density.h"
#include "lib/gather/reachable_area.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// Density estimates over the indirect photons of a dynamic map, in discs that are given: their radii come from the
/// static photons, as those from few dynamic ones are noise. Occlusion and area are those of the standing scene, as
/// PointDensity has them. Thread-safe.
class SignedDensity {
 public:
  /// shift: m, added to the photons' positions.
  SignedDensity(const Tracer& standing, std::span<const formats::Photon> photons, const DensityOptions& options,
                Vec3d shift);

  struct Change {
    Rgbd irradiance{0.0};  ///< W/m^2: sum of flux with its sign / area
    double influence =
        0;  ///< W/m^2: sum of the largest channel of |flux| / area; what comes and what goes do not cancel
  };
  /// m: largest radius of a disc; if the options have none, PointDensity::kSparser times the photons' own reach.
  float max_radius() const { return options_.max_radius; }
  /// Of the photons nearer than `radius` (m; 0: the largest) in the ellipsoid 1 : 1 / kFlattening. Nothing if there
  /// are none. `random`: as for PointDensity::estimate of the same place.
  std::optional<Change> at(Vec3 position, Vec3 normal, float radius, const PathRandom& random) const {
    Area area;
    return at(position, normal, radius, random, area);
  }

  /// What can be reached of a disc of the standing scene: the same for all maps of a segment.
  struct Area {
    bool known = false, whole = false;
    double inverse = 0;  ///< 1/m^2
  };
  /// The same; `area` is found if it is not known yet and needed.
  std::optional<Change> at(Vec3 position, Vec3 normal, float radius, const PathRandom& random, Area& area) const;
  /// What Change::influence is at most, reached or not: no ray is traced for the photons. 0 if there are none.
  double most_influence(Vec3 position, Vec3 normal, float radius, const PathRandom& random, Area& area) const;

 private:
  /// Photons within `radius`, with the area in which they lie; none: area stays as it is.
  void find(Vec3 position, Vec3 normal, float radius, const PathRandom& random, Area& area, NeighbourList& found) const;

  DensityOptions options_;
  ReachableArea area_;
  PhotonIndex index_;
};

}  // namespace tempolux
