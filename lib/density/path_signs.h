// lib/density/path_signs.h -- a random sign for each light path: sums with signs have the variance of sums without.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/density/photon_index.h"

namespace tempolux {

/// Returns 1 or -1 for each photon of `index`, which was made from `photons`. All photons of one light path have the
/// same sign s_j, and the signs of paths are independent. If path j adds x_j to an estimate, the estimate sum x_j over
/// n independent paths has the variance n Var(x), which is about sum x_j^2. That is the mean square of
///
///     sum s_j x_j
///
/// This number is linear in x: the number of a weighted mean of estimates is the weighted mean of their numbers. The
/// photons of a path follow each other by ascending bounce (formats/photons/photons.md, section 3). So a photon whose
/// bounce is not above that of the photon before it belongs to another path. The sign is a hash of the position of a
/// path's first photon.
std::vector<std::int8_t> path_signs(std::span<const formats::Photon> photons, const PhotonIndex& index);

}  // namespace tempolux
