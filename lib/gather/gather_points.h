// lib/gather/gather_points.h -- the irradiance points of a scene, made from whole photon maps, divided ones, or those
// of what stands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/gather/irradiance_points.h"
#include "lib/gather/update_points.h"

namespace tempolux {

/// Points and what they came from.
struct GatherPoints {
  std::vector<IrradiancePoint> points;
  float spacing = 0;    ///< m
  std::string kinds;    ///< that were estimated, or that the scene cannot have: they are 0 then
  std::string history;  ///< of the file they came from, or of the photons
  std::uint64_t emitted_count = 0;
};

/// Two parts of light (photonmap-split): the whole, and of each point the share that the high part has.
struct DividedGatherPoints {
  GatherPoints whole;
  std::vector<float> high_shares;
};

/// The whole map, bit by bit, and its high part.
struct DividedPhotonMap {
  formats::PhotonMap whole, high;
};

/// m: what is added to positions in a file with this origin to bring them into the frame's space.
Vec3d shift_of(const std::array<double, 3>& origin, const SceneFrame& frame);
/// Is `kind` among "caustic,indirect"?
bool holds_kind(const std::string& kinds, const std::string& kind);

/// Points from the photons of a whole map with all kinds of light.
GatherPoints make_points(const formats::PhotonMap& map, const Tracer& tracer, const Lights& lights,
                         const PointOptions& options);
DividedGatherPoints make_points(const DividedPhotonMap& map, const Tracer& tracer, const Lights& lights,
                                const PointOptions& options);

/// The light of a frame where something moves: photons of what stands, and what movers change of them.
struct MovedPhotons {
  const formats::PhotonMap& fixed;
  const formats::PhotonMap& moved;
};
/// Of a frame: from `points` of the standing scene, to which the points on what moves are added (update_points).
/// InputError if they were not made with these options.
PointUpdateCounts update_points(const MovedPhotons& light, const Tracer& whole, const Tracer& standing,
                                const Lights& lights, const PointOptions& options, GatherPoints& points);

}  // namespace tempolux
