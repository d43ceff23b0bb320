#include "lib/gather/place_records.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr std::size_t kBatch = 256;
constexpr int kCoarsest = 16;

/// Pixels of the lattice of `stride` that are on no coarser one, in a fixed shuffled order.
std::vector<std::size_t> lattice(int width, int height, int stride) {
  std::vector<std::size_t> pixels;
  for (int y = 0; y < height; y += stride)
    for (int x = 0; x < width; x += stride) {
      if (stride < kCoarsest && x % (2 * stride) == 0 && y % (2 * stride) == 0) continue;
      pixels.push_back(std::size_t(y) * std::size_t(width) + std::size_t(x));
    }
  std::sort(pixels.begin(), pixels.end(), [](std::size_t a, std::size_t b) {
    const std::uint64_t ka = mix64(a), kb = mix64(b);
    return ka != kb ? ka < kb : a < b;
  });
  return pixels;
}

}  // namespace

void limit_radius(IrradianceRecord& record, float footprint, float max_radius, const PlacementOptions& options) {
  float r = record.radius_unclamped;
  const float e = record.irradiance.r + record.irradiance.g + record.irradiance.b;
  float slope = 0;
  for (Vec3 g : record.translational) slope += length(g);
  if (slope * r > e && slope > 0) r = e / slope;
  r = std::min(options.error_bound * r, record.radius);
  record.radius_unclamped *= options.error_bound;
  record.radius = std::max(std::min(r, max_radius), options.min_radius_px * footprint);
  // A gradient steeper than the irradiance over the smallest radius would extrapolate below zero.
  if (slope * record.radius > e && slope > 0)
    for (Vec3& g : record.translational) g *= e / (slope * record.radius);
}

std::size_t place_records(const FinalGather& gather, const PixelView& view, int width, int height, const Box3& bounds,
                          const PlacementOptions& options, RecordStore& store, GatherCounts& counts,
                          const std::function<void(double)>& progress) {
  const float max_radius = options.max_radius > 0 ? options.max_radius : 0.1f * bounds.diagonal();
  const std::size_t before = store.records().size();
  std::size_t done = 0;
  struct Candidate {
    SeenPoint seen;
    IrradianceRecord record;
  };
  for (int stride = kCoarsest; stride >= 1; stride /= 2) {
    const std::vector<std::size_t> pixels = lattice(width, height, stride);
    // What is covered now stays covered: only the rest is looked at again, batch by batch.
    std::vector<std::optional<SeenPoint>> open(pixels.size());
    parallel_chunks(pixels.size(), 1024, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const std::optional<SeenPoint> seen = view(pixels[i]);
        if (seen && store.interpolate(seen->surface.position, seen->normal).weight < options.min_weight) open[i] = seen;
      }
    });
    std::vector<Candidate> waiting;
    for (const auto& seen : open)
      if (seen) waiting.push_back({*seen, {}});
    for (std::size_t start = 0; start < waiting.size(); start += kBatch) {
      const std::size_t end = std::min(waiting.size(), start + kBatch);
      std::vector<std::uint8_t> needed(end - start);
      std::mutex mutex;
      parallel_chunks(end - start, 8, [&](std::size_t first, std::size_t last) {
        GatherCounts local;
        for (std::size_t i = first; i < last; ++i) {
          Candidate& candidate = waiting[start + i];
          const SeenPoint& seen = candidate.seen;
          if (store.interpolate(seen.surface.position, seen.normal).weight >= options.min_weight) continue;
          needed[i] = 1;
          candidate.record = gather.gather(seen.surface, seen.normal, local);
          limit_radius(candidate.record, seen.footprint, max_radius, options);
        }
        const std::lock_guard lock(mutex);
        counts += local;
      });
      for (std::size_t i = 0; i < end - start; ++i)
        if (needed[i]) store.add(waiting[start + i].record);
    }
    done += pixels.size();
    if (progress) progress(double(done) / (double(width) * height));
  }
  return store.records().size() - before;
}

}  // namespace tempolux
