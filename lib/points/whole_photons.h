// lib/points/whole_photons.h -- combines a static and a dynamic map to the photons of the whole scene.
#pragma once

#include <functional>

#include "lib/core/vec.h"
#include "lib/density/photon_view.h"

namespace tempolux {

/// The static map of a segment and the dynamic map of one of its frames (docs/methods/dynamic.md).
struct PhotonMaps {
  PhotonView fixed, dynamic;
  Vec3d fixed_shift, dynamic_shift;  ///< m, added to positions to bring them into scene space
};

/// The photons of the global map in another order, in scene space: static photons that are not cancelled, and dynamic
/// photons of positive flux. A dynamic photon of negative flux cancels one static photon that equals it in every bit
/// but the sign of the flux. `wanted` selects photons by position (scene space) and photon; it must accept both or
/// neither of two photons that cancel. Directions are kept if all photons have them.
formats::PhotonBlock whole_photons(const PhotonMaps& maps,
                                   const std::function<bool(Vec3, const formats::Photon&)>& wanted);

}  // namespace tempolux
