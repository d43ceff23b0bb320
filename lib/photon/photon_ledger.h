// lib/photon/photon_ledger.h -- shared by the writers of photon maps: the ledger of flux by group, the header, batches
// traced in parallel and written in order, records of media.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "formats/photons/photons.h"
#include "lib/core/arrays.h"
#include "lib/core/parallel.h"
#include "lib/photon/photon_map.h"

namespace tempolux {

/// Adds a batch of the frame to its group's entry of the ledger.
inline void add_to_ledger(const PhotonBatch& batch, std::int32_t frame, formats::GroupFlux& group) {
  group.group = batch.block.group;
  group.frame = frame;
  group.paths += batch.path_count;
  for (int c = 0; c < 3; ++c) {
    const auto i = std::size_t(c);
    group.emitted[i] += batch.emitted[c];
    group.escaped[i] += batch.escaped[c];
    group.absorbed[i] += batch.absorbed[c];
  }
  if (!batch.pilots.empty()) group.pilots = batch.pilots;
}

/// Sets negative sums of absorbed flux to 0. Lossless walls absorb 0 on average, and Russian roulette may make the sum
/// negative.
inline void clamp_absorbed(std::array<double, 3>& absorbed) {
  for (double& flux : absorbed) flux = std::max(flux, 0.0);
}

/// Fills in counts, kinds, columns, pilots and majorants of the tracer's map.
inline void describe_map(const PhotonTracer& tracer, formats::PhotonHeader& header) {
  const PhotonOptions& options = tracer.options();
  header.group_count = tracer.group_count();
  header.emitted_count = tracer.photon_count();
  header.kinds = options.kinds();
  if (options.store_volume) {
    header.majorants = tracer.majorants().hash();
    header.pilots = std::uint32_t(std::min<std::uint64_t>(options.pilots, tracer.members()));
  }
  if (tracer.stores_directions()) header.columns |= formats::column_direction;
}

/// Calls make(i) for each i < count in parallel, and take(i, result) for each result in order.
template <class Make, class Take>
void make_in_order(std::size_t count, const Make& make, const Take& take) {
  using Result = decltype(make(count));
  constexpr int kOfThread = 2;  // results that exist at once: one is made, one waits to be taken
  parallel_ordered(
      count, std::size_t(kOfThread * parallel_thread_count()),
      [&](std::size_t i) -> std::shared_ptr<void> { return std::make_shared<Result>(make(i)); },
      [&](std::size_t i, void* result) { take(i, *static_cast<Result*>(result)); });
}

/// Traces paths first .. last - 1 of a group in batches.
inline std::vector<PhotonBatch> trace_group(const PhotonTracer& tracer, std::uint32_t group, std::uint64_t first,
                                            std::uint64_t last) {
  std::vector<PhotonBatch> batches;
  for (std::uint64_t q = first; q < last; q += PhotonTracer::kBatch)
    batches.push_back(tracer.trace_members(group, q, std::min(last, q + PhotonTracer::kBatch)));
  return batches;
}

/// Writes a photon map from batches.
class BatchWriter {
 public:
  /// `progress` is called with values in [0, 1]; it may be empty.
  BatchWriter(const std::function<void(const void*, std::size_t)>& sink, const formats::PhotonHeader& header,
              const std::function<void(double)>& progress)
      : writer_(sink, header), columns_(header.columns), progress_(progress) {}

  /// Calls trace(i) for each i < count in parallel, writes the batches in order, and calls take(batch) for each.
  /// Returns the counts and the sums of flux.
  template <class Trace, class Take>
  PhotonMapResult write(std::size_t count, const Trace& trace, const Take& take) {
    struct Encoded {
      PhotonBatch batch;
      std::string bytes;
    };
    PhotonMapResult result;
    FluxBalance sum;
    make_in_order(
        count,
        [&](std::size_t i) {
          Encoded item{trace(i), {}};
          if (!item.batch.block.photons.empty()) item.bytes = formats::encode_block(item.batch.block, columns_);
          return item;
        },
        [&](std::size_t i, const Encoded& item) {
          const auto& [batch, bytes] = item;
          if (!bytes.empty()) writer_.write_encoded(bytes, batch.block);
          result.add(batch);
          sum += batch;
          result.touched.insert(result.touched.end(), batch.touched.begin(), batch.touched.end());
          take(batch);
          if (progress_) progress_(double(i + 1) / double(count));
        });
    result.totals.emitted_flux = array_of(sum.emitted);
    result.totals.escaped_flux = array_of(sum.escaped);
    result.totals.absorbed_flux = array_of(sum.absorbed);
    return result;
  }
  /// Completes the file (PhotonWriter::finish) and the totals.
  void finish(formats::PhotonTotals& totals, std::span<const formats::GroupFlux> ledger = {}) {
    totals = writer_.finish(totals, ledger);
  }

 private:
  formats::PhotonWriter writer_;
  std::uint32_t columns_;
  const std::function<void(double)>& progress_;
};

/// A tentative photon stores, in place of a normal, the probability that its collision was real: extinction / majorant,
/// in units of 1/65534.
inline std::array<std::uint16_t, 2> encode_likelihood(float extinction, float majorant) {
  const float share = majorant > 0 ? std::clamp(extinction / majorant, 0.0f, 1.0f) : 0;
  return {std::uint16_t(share * 65534 + 0.5f), 0};
}
/// The extinction [1/m] at a tentative photon when it was recorded. `majorant` [1/m]: the majorant there.
inline float extinction_when_recorded(const formats::Photon& photon, float majorant) {
  return float(photon.normal[0]) / 65534 * majorant;
}

}  // namespace tempolux
