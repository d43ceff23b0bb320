// lib/points/gather_points.h -- the irradiance points of a scene, from whole photon maps, divided ones, or static
// points.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/points/irradiance_points.h"
#include "lib/points/update_points.h"

namespace tempolux {

/// Points, and the facts about them that a file's header holds.
struct GatherPoints {
  std::vector<IrradiancePoint> points;
  float spacing = 0;    ///< m
  std::string kinds;    ///< kinds that were estimated, and kinds that the scene does not have, whose light is 0
  std::string history;  ///< of the points' file, or of the photons
  std::uint64_t emitted_count = 0;  ///< light paths of the photon map
};

/// Points of divided light (photonmap-split).
struct DividedGatherPoints {
  GatherPoints whole;
  std::vector<float> high_shares;  ///< share of each point's light that the high part has; empty: light is not divided

  bool any_high() const {
    return std::ranges::any_of(high_shares, [](float share) { return share > 0; });
  }
};

/// A whole photon map, joined from its two parts, and its high part.
struct DividedPhotonMap {
  formats::PhotonMap whole, high;
};

/// m: the vector that brings positions of a file with this origin into the frame's space.
Vec3d shift_of(const std::array<double, 3>& origin, const SceneFrame& frame);
/// True if `kind` is among `kinds`, such as "caustic,indirect".
bool holds_kind(const std::string& kinds, const std::string& kind);

/// The lights with a SkyGuide that is learned at these points, for light samples at the points and at hits. Without an
/// environment, the lights themselves.
Lights guided_lights(const Tracer& tracer, const Lights& lights, std::span<const IrradiancePoint> points);

/// Places points (place_points) and estimates all kinds of light at them from a whole photon map.
GatherPoints make_points(const formats::PhotonMap& map, const Tracer& tracer, const Lights& lights,
                         const PointOptions& options);
DividedGatherPoints make_points(const DividedPhotonMap& map, const Tracer& tracer, const Lights& lights,
                                const PointOptions& options);

/// The static and the dynamic map of a frame with movers.
struct MovedPhotons {
  const formats::PhotonMap& fixed;
  const formats::PhotonMap& moved;
};
/// Updates `points` of the static scene to a frame (update_points) and adds points on movers. Throws InputError if the
/// points were not made with these options.
PointUpdateCounts update_points(const MovedPhotons& light, const Tracer& whole, const Tracer& static_tracer,
                                const Lights& lights, const PointOptions& options, GatherPoints& points);

}  // namespace tempolux
