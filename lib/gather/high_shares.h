// lib/gather/high_shares.h -- the share of the light at irradiance points that comes from a part of the photons.
#pragma once

#include <span>
#include <vector>

#include "lib/gather/irradiance_points.h"

namespace tempolux {

/// For each point, the share in [0, 1] of its irradiance (direct, caustic, indirect; sum of the channels) that comes
/// from the photons `high`, by the same density estimate as estimate_points. `whole`: points estimated from all
/// photons. The two densities use different discs, so the share is only an estimate. Light sampled with it stays
/// unbiased, because BrightPoints divides light exactly for any shares. 0 at a point without light.
std::vector<float> shares_of_photons(const Tracer& tracer, const Lights& lights, const formats::PhotonMap& high,
                                     PointOptions options, std::span<const IrradiancePoint> whole);

}  // namespace tempolux
