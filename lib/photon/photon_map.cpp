#include "lib/photon/photon_map.h"

#include <algorithm>
#include <memory>
#include <string>

#include "lib/core/parallel.h"

namespace tempolux {
namespace {

constexpr int kBatchesPerThread = 2;   ///< in flight, 100 kB each: one is traced, one waits for its turn

struct EncodedBatch {
  PhotonBatch batch;
  std::string bytes;
};

std::array<double, 3> to_array(const Rgbd& c) { return {c.r, c.g, c.b}; }

void add_to_ledger(const PhotonBatch& batch, std::int32_t frame, std::vector<formats::GroupFlux>& ledger) {
  formats::GroupFlux& group = ledger[batch.block.group];
  group.group = batch.block.group;
  group.frame = frame;
  group.paths += batch.path_count;
  for (int c = 0; c < 3; ++c) {
    const auto i = std::size_t(c);
    group.emitted[i] += batch.emitted[c];
    group.escaped[i] += batch.escaped[c];
    group.absorbed[i] += batch.absorbed[c];
  }
}

}  // namespace

PhotonMapResult write_photon_map(const PhotonTracer& tracer, const PhotonOptions& options,
                                 formats::PhotonHeader header,
                                 const std::function<void(const void*, std::size_t)>& sink,
                                 const std::function<void(double)>& progress) {
  PhotonMapResult result;
  header.group_count = tracer.group_count();
  header.emitted_count = tracer.photon_count();
  header.kinds = options.kinds();
  if (options.store_volume) header.majorants = tracer.majorants().hash();
  if (tracer.stores_directions()) header.columns |= formats::column_direction;
  formats::PhotonWriter writer(
      [&](const void* data, std::size_t size) {
        sink(data, size);
        result.byte_count += size;
      },
      header);

  Rgbd emitted{0.0}, escaped{0.0}, absorbed{0.0};
  std::vector<formats::GroupFlux> ledger;   // only with tentative photons
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
        result.path_count += item.batch.path_count;
        result.ray_count += item.batch.ray_count;
        result.specular_ray_count += item.batch.specular_ray_count;
        result.seen_count += item.batch.seen_count;
        emitted += item.batch.emitted;
        escaped += item.batch.escaped;
        absorbed += item.batch.absorbed;
        result.touched.insert(result.touched.end(), item.batch.touched.begin(), item.batch.touched.end());
        result.medium_steps += item.batch.medium_steps;
        if (!ledger.empty()) add_to_ledger(item.batch, header.identity.first_frame, ledger);
        if (progress) progress(double(i + 1) / double(tracer.batch_count()));
      });
  result.totals.emitted_flux = to_array(emitted);
  result.totals.escaped_flux = to_array(escaped);
  // What lossless walls absorb is 0 in the mean, and what roulette gives and takes may leave it below.
  for (double& flux : result.totals.absorbed_flux = to_array(absorbed)) flux = std::max(flux, 0.0);
  // Of a group roulette may leave a little less than nothing absorbed; of the whole map hardly.
  for (formats::GroupFlux& group : ledger)
    for (double& flux : group.absorbed) flux = std::max(flux, 0.0);
  writer.finish(result.totals, ledger);
  return result;
}

}  // namespace tempolux
