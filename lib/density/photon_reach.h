// lib/density/photon_reach.h -- the radius of density estimates, from the photons' own spacing.
#pragma once

#include <functional>

#include "lib/density/photon_index.h"

namespace tempolux {

/// m: the radius within which 95 of 100 photons have `neighbours` others, in the ellipsoid of density estimates
/// (irradiance_estimate.h). Measured at up to 1000 photons, at regular steps through the index. 0 for an empty index;
/// if the index has no more than `neighbours` photons, the distance of the farthest photon found. The radius depends on
/// the photons only: with ten times as many photons it is sqrt(10) times as small. `where` selects the photons to
/// measure at, by position; if it is empty or selects none, all photons count.
float photon_reach(const PhotonIndex& index, int neighbours, const std::function<bool(Vec3)>& where = {});

}  // namespace tempolux
