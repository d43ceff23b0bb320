#include "lib/render/pilot_photons.h"

#include "lib/core/parallel_each.h"
#include "lib/photon/photon_trace.h"

namespace tempolux {

formats::PhotonBlock pilot_photons(const Tracer& tracer, const Lights& lights, const std::string& kinds,
                                   std::uint64_t paths, std::uint64_t seed) {
  PhotonOptions options;
  options.seed = seed;
  options.photon_count = paths;
  options.group_count = 1;
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

}  // namespace tempolux
