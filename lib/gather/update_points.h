// lib/gather/update_points.h -- irradiance points of a frame from those of the static scene
// (docs/methods/dynamic.md).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/gather/irradiance_points.h"
#include "lib/scene/static_scene.h"

namespace tempolux {

/// The scene at a frame with and without movers, and the light in it.
struct PointUpdateInput {
  const Tracer& whole;
  const Tracer& standing;
  const Lights& lights;               ///< at the frame
  PhotonView static_photons;          ///< of the segment
  PhotonView dynamic_photons;         ///< of the frame
  Vec3d static_shift, dynamic_shift;  ///< m, added to their positions
};

/// Numbers of points that an update changed.
struct PointUpdateCounts {
  std::size_t direct = 0;   ///< points whose direct light was sampled anew
  std::size_t changed = 0;  ///< points to whose indirect light dynamic photons were added
  std::size_t anew = 0;     ///< points close to movers, estimated anew
};

/// Decides which static photons update_points() reads: photons close to movers, and caustic photons if the dynamic
/// map holds a caustic photon. The other photons need not be in memory. `points`: as passed to update_points(). The
/// function's arguments are a place in scene space and the photon.
std::function<bool(Vec3, const formats::Photon&)> static_photons_read(const SceneFrame& frame,
                                                                      const PointOptions& options,
                                                                      std::span<const IrradiancePoint> points,
                                                                      std::span<const formats::Photon> dynamic_photons);

/// Updates points on static surfaces to a frame. `points` were estimated in the static scene, with these options,
/// from the static photons.
/// - Indirect light [W/m^2]: E = max(0, E_static + sum of the signed flux of dynamic photons closer than the point's
/// radius / area). Disc, occlusion and area are those of the static estimate. The sum is taken before it is clamped
/// at 0.
/// - Points whose disc a mover may cut are estimated anew, from the static photons that are not cancelled and the
/// dynamic photons of positive flux. So is the caustic light of all points if a dynamic photon is caustic.
/// - Direct light is sampled anew where a shadow ray can meet a mover, or everywhere if a light moves or changes.
/// A dynamic photon of negative flux cancels the static photon that equals it in every bit but the sign of the flux.
/// Same results for any number of threads.
PointUpdateCounts update_points(const PointUpdateInput& input, const PointOptions& options,
                                std::vector<IrradiancePoint>& points);

}  // namespace tempolux
