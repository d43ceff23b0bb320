#include "lib/photon/photon_map.h"

#include <algorithm>
#include <memory>
#include <string>

#include "lib/core/parallel.h"
#include "lib/photon/photon_ledger.h"

namespace tempolux {
namespace {

constexpr int kBatchesPerThread = 2;  ///< in flight, 100 kB each: one is traced, one waits to be written

struct EncodedBatch {
  PhotonBatch batch;
  std::string bytes;
};

}  // namespace

PhotonMapResult write_photon_map(const PhotonTracer& tracer, const PhotonOptions& options, formats::PhotonHeader header,
                                 const std::function<void(const void*, std::size_t)>& sink,
                                 const std::function<void(double)>& progress) {
  PhotonMapResult result;
  describe_map(tracer, options, header);
  formats::PhotonWriter writer(sink, header);

  Rgbd emitted{0.0}, escaped{0.0}, absorbed{0.0};
  std::vector<formats::GroupFlux> ledger;  // only with tentative photons
  if (options.store_volume) ledger.resize(header.group_count);
  parallel_ordered(
      tracer.batch_count(), std::size_t(kBatchesPerThread * parallel_thread_count()),
      [&](std::size_t i) -> std::shared_ptr<void> {
        auto item = std::make_shared<EncodedBatch>();
        item->batch = tracer.trace(i);
        if (!item->batch.block.photons.empty()) item->bytes = formats::encode_block(item->batch.block, header.columns);
        return item;
      },
      [&](std::size_t i, void* pointer) {
        const auto& item = *static_cast<const EncodedBatch*>(pointer);
        if (!item.bytes.empty()) writer.write_encoded(item.bytes, item.batch.block);
        result.totals.photon_count += item.batch.block.photons.size();
        count(item.batch, result);
        emitted += item.batch.emitted;
        escaped += item.batch.escaped;
        absorbed += item.batch.absorbed;
        result.touched.insert(result.touched.end(), item.batch.touched.begin(), item.batch.touched.end());
        if (!ledger.empty()) add_to_ledger(item.batch, header.identity.first_frame, ledger[item.batch.block.group]);
        if (progress) progress(double(i + 1) / double(tracer.batch_count()));
      });
  result.totals.emitted_flux = as_array(emitted);
  result.totals.escaped_flux = as_array(escaped);
  // Lossless walls absorb 0 on average; Russian roulette may make the sum negative.
  for (double& flux : result.totals.absorbed_flux = as_array(absorbed)) flux = std::max(flux, 0.0);
  for (formats::GroupFlux& group : ledger) close_ledger(group);
  writer.finish(result.totals, ledger);
  return result;
}

}  // namespace tempolux
