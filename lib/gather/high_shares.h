// lib/gather/high_shares.h -- of the light at irradiance points, the share that a part of the photons has.
#pragma once

#include <span>
#include <vector>

#include "lib/gather/irradiance_points.h"

namespace tempolux {

/// For each point the share, from 0 to 1, of its irradiance (direct, caustic, indirect; all channels added) that the
/// photons `high` bring there, by the density of photons as estimate_points has it. `whole`: points estimated from all
/// photons. Two densities with different photons have different discs, so the share is an estimate. What is sampled by
/// it stays unbiased: BrightPoints divides light exactly, whatever the shares are. A point without light has share 0.
std::vector<float> shares_of_photons(const Tracer& tracer, const Lights& lights, const formats::PhotonMap& high,
                                     PointOptions options, std::span<const IrradiancePoint> whole);

}  // namespace tempolux
