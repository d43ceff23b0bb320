#include "lib/photon/photon_map.h"

#include "lib/photon/photon_ledger.h"

namespace tempolux {

PhotonMapResult write_photon_map(const PhotonTracer& tracer, formats::PhotonHeader header,
                                 const std::function<void(const void*, std::size_t)>& sink,
                                 const std::function<void(double)>& progress) {
  describe_map(tracer, header);
  BatchWriter writer(sink, header, progress);
  std::vector<formats::GroupFlux> ledger;  // only with tentative photons
  if (tracer.options().store_volume) ledger.resize(header.group_count);
  PhotonMapResult result = writer.write(
      tracer.batch_count(), [&](std::size_t i) { return tracer.trace(i); },
      [&](const PhotonBatch& batch) {
        if (!ledger.empty()) add_to_ledger(batch, header.identity.first_frame, ledger[batch.block.group]);
      });
  clamp_absorbed(result.totals.absorbed_flux);
  for (formats::GroupFlux& group : ledger) clamp_absorbed(group.absorbed);
  writer.finish(result.totals, ledger);
  return result;
}

}  // namespace tempolux
