// lib/gather/update_points.h -- irradiance points of a frame from those of what stands (docs/methods/dynamic.md).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "formats/photons/photons.h"
#include "lib/gather/irradiance_points.h"
#include "lib/scene/static_scene.h"

namespace tempolux {

/// The scene at a frame with and without what moves, and the light in it.
struct PointUpdateInput {
  const Tracer& whole;
  const Tracer& standing;
  const Lights& lights;               ///< at the frame
  PhotonView static_photons;          ///< of the segment
  PhotonView dynamic_photons;         ///< of the frame
  Vec3d static_shift, dynamic_shift;  ///< m, added to their positions
};

/// What an update did.
struct PointUpdateCounts {
  std::size_t direct = 0;   ///< points whose direct light was sampled anew
  std::size_t changed = 0;  ///< points to whose indirect light dynamic photons were added
  std::size_t anew = 0;     ///< points beside what moves, estimated anew
};

/// Which static photons update_points() reads: those near what moves, and caustic ones if any dynamic one is caustic.
/// The others need not be in memory. `points` as they come to update_points(); places in scene space.
std::function<bool(Vec3, const formats::Photon&)> static_photons_read(const SceneFrame& frame,
                                                                      const PointOptions& options,
                                                                      std::span<const IrradiancePoint> points,
                                                                      std::span<const formats::Photon> dynamic_photons);

/// Points on static surfaces, first as they were estimated in the standing scene, with these options, from the static
/// photons:
/// - indirect: E = max(0, E_static + sum of signed flux of the dynamic photons nearer than the point's radius / area),
/// the
///   static estimate's disc, occlusion and area; summed before it is cut at 0;
/// - where what moves cuts the disc, and caustic light if any of it is dynamic: estimated anew from the static photons
///   without those that a dynamic one takes away, and the dynamic ones that come;
/// - direct: sampled anew where a shadow ray can meet what moves, or everywhere if a light moves or changes.
/// A dynamic photon takes away the static one that is equal to it in every bit but the sign of its flux. Same results
/// for any number of threads.
PointUpdateCounts update_points(const PointUpdateInput& input, const PointOptions& options,
                                std::vector<IrradiancePoint>& points);

}  // namespace tempolux
