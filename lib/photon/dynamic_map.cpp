#include "lib/photon/dynamic_map.h"

#include <algorithm>

#include "lib/photon/photon_ledger.h"

namespace tempolux {
namespace {

/// The photons of a batch sorted by path, those of a path by bounce.
struct ByPath {
  std::vector<std::uint32_t> first;    ///< by path: index of its first photon in `photons`
  std::vector<std::uint32_t> photons;  ///< indices into the batch

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

/// The photon with negative flux. The function computes 0 - x, because -x would turn a flux of 0 into -0.
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
    result += after.balance_of[number_of[path]] - before.balance_of[path];
  }
  result.add(before);
  result.add(after);
  return result;
}

PhotonMapResult write_dynamic_map(const PhotonTracer& static_scene, const PhotonTracer& whole,
                                  std::span<const std::uint64_t> paths, formats::PhotonHeader header,
                                  const std::function<void(const void*, std::size_t)>& sink,
                                  const std::function<void(double)>& progress) {
  // Cuts the paths into pieces of one group each, of at most kBatch paths.
  std::vector<std::size_t> borders{0};
  for (std::size_t i = 1; i < paths.size(); ++i)
    if (paths[i] % whole.group_count() != paths[i - 1] % whole.group_count() ||
        i - borders.back() == PhotonTracer::kBatch)
      borders.push_back(i);
  if (!paths.empty()) borders.push_back(paths.size());

  describe_map(whole, header);
  BatchWriter writer(sink, header, progress);
  PhotonMapResult result = writer.write(
      borders.size() - 1,
      [&](std::size_t i) {
        return difference_of(static_scene, whole, paths.subspan(borders[i], borders[i + 1] - borders[i]));
      },
      [](const PhotonBatch&) {});
  writer.finish(result.totals);
  return result;
}

}  // namespace tempolux
