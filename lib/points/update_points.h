// lib/points/update_points.h -- irradiance points of a frame from those of the static scene
// (docs/methods/dynamic.md).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/points/irradiance_points.h"
#include "lib/points/whole_photons.h"
#include "lib/scene/static_scene.h"

namespace tempolux {

/// The scene of a frame, the scene without movers, and their light.
struct PointUpdateInput {
  const Tracer& whole;
  const Tracer& static_scene;
  const Lights& lights;  ///< of the frame
  PhotonMaps photons;
};

/// Numbers of points that an update changed.
struct PointUpdateCounts {
  std::size_t direct = 0;   ///< points whose direct light was sampled again
  std::size_t changed = 0;  ///< points to whose indirect light the flux of dynamic photons was added
  std::size_t anew = 0;     ///< points close to movers, which were estimated again
};

/// A function that is true for the static photons that update_points() reads, so that the others need not be in memory.
/// It reads photons close to movers, and caustic photons if the dynamic map holds a caustic photon. `points`: as passed
/// to update_points(). The arguments of the function are the photon's position in scene space and the photon.
std::function<bool(Vec3, const formats::Photon&)> static_photons_read(const SceneFrame& frame,
                                                                      const PointOptions& options,
                                                                      std::span<const IrradiancePoint> points,
                                                                      std::span<const formats::Photon> dynamic_photons);

/// Updates points on static surfaces to a frame. `points` must have been estimated in the static scene, with these
/// options, from the static photons.
/// - Indirect light [W/m^2] becomes max(0, E_static + (signed flux of the reachable dynamic photons within the point's
/// radius) / area). Disc, reachability and area are those of the static estimate.
/// - If a mover may cut a point's disc, the point is estimated again, from whole_photons(). If a dynamic photon is
/// caustic, the caustic light of all points is estimated again.
/// - Direct light is sampled again at points with a shadow ray that can meet a mover, or at all points if a light moves
/// or changes. Same results for any number of threads.
PointUpdateCounts update_points(const PointUpdateInput& input, const PointOptions& options,
                                std::vector<IrradiancePoint>& points);

}  // namespace tempolux
