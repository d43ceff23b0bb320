#include "lib/photon/dynamic_map.h"

#include <algorithm>
#include <memory>

#include "lib/core/parallel.h"
#include "lib/photon/photon_ledger.h"

namespace tempolux {
namespace {

constexpr int kChunksPerThread = 2;  ///< in flight

struct Piece {
  PhotonBatch batch;
  std::string bytes;
};

/// The photons of a batch sorted by path: path i has the photons first[i] to first[i + 1] - 1, in order of bounce.
struct ByPath {
  std::vector<std::uint32_t> first, photons;

  ByPath(const PhotonBatch& batch, std::size_t path_count) : first(path_count + 1), photons(batch.path_of.size()) {
    for (const std::uint32_t path : batch.path_of) ++first[path + 1];
    for (std::size_t i = 0; i < path_count; ++i) first[i + 1] += first[i];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t p = 0; p < batch.path_of.size(); ++p) photons[next[batch.path_of[p]]++] = p;
  }
  std::span<const std::uint32_t> of(std::size_t path) const {
    return std::span(photons).subspan(first[path], first[path + 1] - first[path]);
  }
};

/// The photon with negative flux. 0 - x is computed instead of -x, so that a flux of 0 stays +0.
formats::Photon negative(formats::Photon photon) {
  for (float& flux : photon.flux) flux = 0 - flux;
  return photon;
}

}  // namespace

PhotonBatch difference_of(const PhotonTracer& static_scene, const PhotonTracer& whole,
                          std::span<const std::uint64_t> paths) {
  // A path that no mover touches in the whole scene is the same in the static scene.
  const PhotonBatch after = whole.trace_paths(paths);
  std::vector<std::uint64_t> others;
  std::vector<std::uint32_t> number_of;  // in `paths`
  for (std::uint32_t path = 0; path < paths.size(); ++path)
    if (after.moved[path]) others.push_back(paths[path]), number_of.push_back(path);
  const PhotonBatch before = static_scene.trace_paths(others);
  const ByPath old(before, others.size()), now(after, paths.size());
  PhotonBatch result;
  result.block.group = std::uint32_t(paths[0] % static_scene.group_count());
  for (std::size_t path = 0; path < others.size(); ++path) {
    const auto a = old.of(path), b = now.of(number_of[path]);
    std::size_t common = 0;
    while (common < std::min(a.size(), b.size()) && before.block.photons[a[common]] == after.block.photons[b[common]])
      ++common;
    const auto take = [&](const PhotonBatch& from, std::uint32_t p, const formats::Photon& photon) {
      result.block.photons.push_back(photon);
      if (!from.block.directions.empty()) result.block.directions.push_back(from.block.directions[p]);
    };
    for (const std::uint32_t p : a.subspan(common)) take(before, p, negative(before.block.photons[p]));
    for (const std::uint32_t p : b.subspan(common)) take(after, p, after.block.photons[p]);
    const FluxBalance &was = before.balance_of[path], &is = after.balance_of[number_of[path]];
    result.emitted += is.emitted - was.emitted;
    result.escaped += is.escaped - was.escaped;
    result.absorbed += is.absorbed - was.absorbed;
  }
  result.path_count = before.path_count + after.path_count;
  result.ray_count = before.ray_count + after.ray_count;
  result.specular_ray_count = before.specular_ray_count + after.specular_ray_count;
  return result;
}

PhotonMapResult write_dynamic_map(const PhotonTracer& static_scene, const PhotonTracer& whole,
                                  std::span<const std::uint64_t> paths, const PhotonOptions& options,
                                  formats::PhotonHeader header,
                                  const std::function<void(const void*, std::size_t)>& sink,
                                  const std::function<void(double)>& progress) {
  // Borders of pieces: each piece has paths of one group, at most a batch.
  std::vector<std::size_t> borders{0};
  for (std::size_t i = 1; i < paths.size(); ++i)
    if (paths[i] % whole.group_count() != paths[i - 1] % whole.group_count() ||
        i - borders.back() == PhotonTracer::kBatch)
      borders.push_back(i);
  if (!paths.empty()) borders.push_back(paths.size());

  PhotonMapResult result;
  header.group_count = whole.group_count();
  header.emitted_count = whole.photon_count();
  header.kinds = options.kinds();
  if (whole.stores_directions()) header.columns |= formats::column_direction;
  formats::PhotonWriter writer(sink, header);
  Rgbd emitted{0.0}, escaped{0.0}, absorbed{0.0};
  parallel_ordered(
      borders.size() - 1, std::size_t(kChunksPerThread * parallel_thread_count()),
      [&](std::size_t i) -> std::shared_ptr<void> {
        auto piece = std::make_shared<Piece>();
        piece->batch = difference_of(static_scene, whole, paths.subspan(borders[i], borders[i + 1] - borders[i]));
        if (!piece->batch.block.photons.empty())
          piece->bytes = formats::encode_block(piece->batch.block, header.columns);
        return piece;
      },
      [&](std::size_t i, void* pointer) {
        const auto& piece = *static_cast<const Piece*>(pointer);
        if (!piece.bytes.empty()) writer.write_encoded(piece.bytes, piece.batch.block);
        result.path_count += piece.batch.path_count;
        result.ray_count += piece.batch.ray_count;
        result.specular_ray_count += piece.batch.specular_ray_count;
        emitted += piece.batch.emitted;
        escaped += piece.batch.escaped;
        absorbed += piece.batch.absorbed;
        if (progress) progress(double(i + 1) / double(borders.size() - 1));
      });
  result.totals.emitted_flux = as_array(emitted);
  result.totals.escaped_flux = as_array(escaped);
  result.totals.absorbed_flux = as_array(absorbed);
  result.totals = writer.finish(result.totals);
  return result;
}

}  // namespace tempolux
