// lib/pilot/rough_light.h -- irradiance points and bright points of a pilot, in place of a frame's files.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/gather/bright_points.h"
#include "lib/gather/final_gather.h"
#include "lib/irradcache/points.h"
#include "lib/light/aim.h"
#include "lib/points/irradiance_points.h"
#include "lib/render/known_light.h"

namespace tempolux {

/// Points on all surfaces, and the bright points beside lamps, made of a pilot's photons.
class RoughLight {
 public:
  static constexpr int kRays = FinalGather::kDistanceRays;  ///< gather rays of a rough record

  /// Makes the points of `photons`, which kPilotPaths light paths have left. The frame's map has `paths` light paths:
  /// radii of points are reduced to those of this map, so that as many hits are close hits as in the frame. Points lie
  /// in the spheres `seen`, or everywhere if there is none. `scene` must outlive this object.
  RoughLight(const RenderScene& scene, const formats::PhotonBlock& photons, std::uint64_t paths, std::uint64_t seed,
             std::span<const AimSphere> seen);

  /// The light that samples of pixels may read from the points. Bright points are left out, because usually only
  /// records sample bright points explicitly. The result is valid as long as this object.
  KnownLight known() const;
  /// Options of a rough record.
  GatherOptions gathering(std::uint64_t seed) const;
  const PointLookup& lookup() const { return *lookup_; }

 private:
  PlacedPoints placed_;
  std::optional<PointLookup> lookup_;
  std::vector<LampPhoton> lamps_;
  std::optional<BrightPoints> bright_;
};

}  // namespace tempolux
