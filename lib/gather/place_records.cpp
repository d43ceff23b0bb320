#include "lib/gather/place_records.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/parallel_each.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr int kCoarsest = 16;  ///< pixels: stride of the first lattice

/// Pixels of the lattice of this stride that are on no coarser lattice, row by row.
std::vector<std::size_t> lattice(int width, int height, int stride) {
  std::vector<std::size_t> pixels;
  for (int y = 0; y < height; y += stride)
    for (int x = 0; x < width; x += stride) {
      if (stride < kCoarsest && x % (2 * stride) == 0 && y % (2 * stride) == 0) continue;
      pixels.push_back(std::size_t(y) * std::size_t(width) + std::size_t(x));
    }
  return pixels;
}

/// Adds records at points that are not yet covered.
class Placement {
 public:
  Placement(const FinalGather& gather, const RecordSource* source, const PlacementOptions& options, RecordStore& store,
            GatherCounts& counts)
      : gather_(gather), source_(source), options_(options), store_(store), counts_(counts) {}

  bool is_covered(const SeenPoint& seen) const {
    return store_.covers(seen.surface.position, seen.normal, options_.min_weight);
  }

  /// Adds the records that the points still need, in batches.
  void add(std::span<const SeenPoint> points) {
    for (std::size_t start = 0; start < points.size(); start += kPlacedTogether)
      add_batch(points.subspan(start, std::min(kPlacedTogether, points.size() - start)));
  }

 private:
  void add_batch(std::span<const SeenPoint> points) {
    std::vector<std::optional<IrradianceRecord>> records(points.size());
    counts_ += parallel_sum<GatherCounts>(points.size(), 8, [&](std::size_t i, GatherCounts& counts) {
      const SeenPoint& seen = points[i];
      if (is_covered(seen)) return;
      if (source_) {
        records[i] = source_->gather(seen, i, counts);
        return;
      }
      records[i] = gather_.gather(seen.surface, seen.normal, counts);
      limit_radius(*records[i], seen.footprint, options_);
      gather_.look_around(seen.surface, *records[i]);
    });
    for (std::size_t i = 0; i < records.size(); ++i)
      if (records[i] && store_.add(*records[i]) && source_ && source_->added) source_->added(i);
  }

  const FinalGather& gather_;
  const RecordSource* source_;
  const PlacementOptions& options_;
  RecordStore& store_;
  GatherCounts& counts_;
};

/// A picture whose points get records.
struct Looked {
  const PixelView& view;
  Placement& placement;

  /// Covers the points of `pixels`, in a fixed shuffled order. look(pixel) returns the raster position of a pixel;
  /// note(pixel, seen) receives its point.
  template <class LookAt, class Note>
  void cover(const std::vector<std::size_t>& pixels, const LookAt& look, const Note& note) const {
    struct Open {
      std::uint64_t key;  // sort key: hash of the pixel
      std::size_t pixel;
      SeenPoint seen;
    };
    // A covered point stays covered, so only points that are open here are sorted and tested again, batch by batch.
    std::vector<Open> open = parallel_found<Open>(pixels.size(), 1024, [&](std::size_t i, std::vector<Open>& found) {
      const std::optional<SeenPoint> seen = view(look(pixels[i]));
      if (!seen) return;
      note(pixels[i], *seen);
      if (!placement.is_covered(*seen)) found.push_back({mix64(pixels[i]), pixels[i], *seen});
    });
    std::sort(open.begin(), open.end(),
              [](const Open& a, const Open& b) { return a.key != b.key ? a.key < b.key : a.pixel < b.pixel; });
    std::vector<SeenPoint> points;
    for (const Open& o : open) points.push_back(o.seen);
    placement.add(points);
  }
};

/// The radius [m] before min_radius_px is applied.
float radius_by_distances(const IrradianceRecord& record, float footprint, const PlacementOptions& options) {
  return std::min(options.max_radius, std::isinf(record.radius_unclamped)
                                          ? options.unseen_radius_px * footprint
                                          : options.error_bound * record.radius_unclamped);
}

}  // namespace

float noise_factor(const GatherCounts& counts) {
  return counts.twice_noise > 0 ? float(std::sqrt(counts.twice_variance / counts.twice_noise)) : 1.0f;
}

float radius_of(const IrradianceRecord& record, float footprint, const PlacementOptions& options) {
  return std::max(radius_by_distances(record, footprint, options), options.min_radius_px * footprint);
}

void limit_radius(IrradianceRecord& record, float footprint, const PlacementOptions& options) {
  record.radius = radius_of(record, footprint, options);
  record.radius_unclamped = radius_by_distances(record, footprint, options);
  // The sums are in double, so that they stay finite for light of any strength.
  double kept = std::min(1.0, double(record.radius_unclamped) / double(record.radius)), slope = 0;
  for (Vec3 g : record.translational) slope += length(Vec3d(g));
  const double e = channel_sum(Rgbd(record.irradiance)), over = kept * slope * double(record.radius);
  if (over > e) kept *= e / over;
  for (Vec3& g : record.translational) g *= float(kept);
}

void cover_points(const FinalGather& gather, const RecordSource* source, const PlacementOptions& options,
                  std::span<const SeenPoint> points, RecordStore& store, GatherCounts& counts) {
  const std::size_t before = store.records().size();
  Placement(gather, source, options, store, counts).add(points);
  store.complete_noise(before, noise_factor(counts));
}

std::size_t place_records(const FinalGather& gather, const RecordPicture& picture, const PlacementOptions& options,
                          RecordStore& store, GatherCounts& counts) {
  const int width = picture.width, height = picture.height;
  const std::size_t before = store.records().size();
  Placement placement(gather, picture.source, options, store, counts);
  const Looked looked{picture.view, placement};
  std::vector<Glimpse> glimpses(std::size_t(width) * std::size_t(height));
  std::size_t done = 0;
  const auto advance = [&](std::size_t pixels) {
    done += pixels;
    if (picture.progress) picture.progress(double(done) / (2 * double(width) * height));
  };
  for (int stride = kCoarsest; stride >= 1; stride /= 2) {
    const std::vector<std::size_t> pixels = lattice(width, height, stride);
    looked.cover(
        pixels, [&](std::size_t pixel) { return centre_look(pixel, width); },
        [&](std::size_t pixel, const SeenPoint& seen) { glimpses[pixel] = Glimpse(seen); });
    advance(pixels.size());
  }
  const std::vector<std::size_t> edges = edge_pixels(glimpses, width, height);
  for (std::uint32_t k = 0; k < kEdgeLooks; ++k) {
    const auto look = [&](std::size_t pixel) { return edge_look(pixel, width, k); };
    looked.cover(edges, look, [](std::size_t, const SeenPoint&) {});
    advance(edges.size() / kEdgeLooks);
  }
  store.complete_noise(before, noise_factor(counts));
  return store.records().size() - before;
}

}  // namespace tempolux
