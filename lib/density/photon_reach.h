// lib/density/photon_reach.h -- the radius of density estimates, from the photons' own spacing.
#pragma once

#include <functional>

#include "lib/density/photon_index.h"

namespace tempolux {

/// m: the radius within which 95 of 100 photons have `neighbours` others on their side of the surface, in an ellipsoid
/// `flattening` times as wide as high. Measured at up to 1000 photons, spaced evenly over the index. 0 for an empty
/// index; if the index has no more than `neighbours` photons, the distance of the farthest photon found. The radius
/// depends on the photons only: with ten times as many photons it is sqrt(10) times as small. `where` selects the
/// photons to measure at; if it selects none, all.
float photon_reach(const PhotonIndex& index, int neighbours, float min_cos, float flattening,
                   const std::function<bool(Vec3)>& where = {});

}  // namespace tempolux
