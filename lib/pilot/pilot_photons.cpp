#include "lib/pilot/pilot_photons.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel_each.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

formats::PhotonBlock pilot_photons(const Tracer& tracer, const Lights& lights, const std::string& kinds,
                                   std::uint64_t paths, std::uint64_t seed, bool directions) {
  PhotonOptions options{.seed = seed, .photon_count = paths, .group_count = 1, .store_directions = directions};
  options.set_kinds(kinds);
  const PhotonTracer photons_of(tracer, lights, options);
  std::vector<PhotonBatch> batches(photons_of.batch_count());
  parallel_each(batches.size(), 1, [&](std::size_t b) { batches[b] = photons_of.trace(b); });
  formats::PhotonBlock all;
  for (const PhotonBatch& batch : batches) {
    all.photons.insert(all.photons.end(), batch.block.photons.begin(), batch.block.photons.end());
    all.directions.insert(all.directions.end(), batch.block.directions.begin(), batch.block.directions.end());
  }
  return all;
}

std::uint64_t photon_paths(double photons_per_path, std::uint64_t usual) {
  constexpr double kPathsAPhoton = 70;
  const double times = photons_per_path > 0 ? 1 / (kPathsAPhoton * photons_per_path) : kMostTimesPhotons;
  return usual << int(std::ceil(std::log2(std::clamp(times, 1.0, kMostTimesPhotons))));
}

}  // namespace tempolux
