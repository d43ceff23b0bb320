// lib/density/path_signs.h -- a random sign for each light path: sums with signs have the variance of sums without.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/density/photon_index.h"

namespace tempolux {

/// 1 or -1 by photon of `index`, which was made from `photons`. All photons of one light path have the same sign, and
/// the signs of paths are independent. If a path adds x_j to an estimate, the estimate sum x_j of independent paths has
/// the variance n Var(x) = about sum x_j^2, and that is the mean square of
///
///     sum s_j x_j
///
/// This number is linear, so any weighted mean of estimates has the weighted mean of their numbers. The photons of a
/// path follow each other by ascending bounce (formats/photons/photons.md, section 3); a photon whose bounce is not
/// above that of the photon before it belongs to another path. The sign is a hash of the position of a path's first
/// photon.
std::vector<std::int8_t> path_signs(std::span<const formats::Photon> photons, const PhotonIndex& index);

}  // namespace tempolux
