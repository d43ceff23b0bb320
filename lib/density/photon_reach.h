// lib/density/photon_reach.h -- how far estimates reach, from the photons' own spacing.
#pragma once

#include <functional>

#include "lib/density/photon_index.h"

namespace tempolux {

/// m: the radius within which 95 of 100 photons have `neighbours` others on their side of the surface, in the ellipsoid
/// that is `flattening` times as wide as high, by up to 1000 of them spread evenly over the index. 0 of an empty index;
/// of one with no more photons than that, the distance of the farthest they find. A length of the photons, whatever
/// else the scene holds: ten times as many photons are spaced sqrt(10) times as close. `where`: of the photons there
/// alone; if there are none, of all.
float photon_reach(const PhotonIndex& index, int neighbours, float min_cos, float flattening,
                   const std::function<bool(Vec3)>& where = {});

}  // namespace tempolux
