// lib/gather/whole_photons.h -- the photons of the whole scene, put together from a static and a dynamic map.
#pragma once

#include <functional>

#include "lib/core/vec.h"
#include "lib/density/photon_view.h"

namespace tempolux {

/// The maps of a segment and of one of its frames (docs/methods/dynamic.md).
struct PhotonMaps {
  PhotonView fixed, dynamic;
  Vec3d fixed_shift, dynamic_shift;  ///< m, added to their positions: they are then in scene space
};

/// Static photons but those that a dynamic one of negative flux takes away, being equal to it in every bit but the sign
/// of its flux, and dynamic ones of positive flux: those of the global map, in another order. Of these the ones that
/// `wanted` takes, told by place (scene space) and photon; it must take both or neither of two that cancel. Their
/// positions are moved into scene space. Directions, if both maps have them (or one has no photons).
formats::PhotonBlock whole_photons(const PhotonMaps& maps,
                                   const std::function<bool(Vec3, const formats::Photon&)>& wanted);

}  // namespace tempolux
