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

/// The properties of a pixel's seen point that decide whether an edge lies between two pixels.
struct Glimpse {
  Vec3 position, normal;
  float footprint = 0;
  std::uint32_t object = 0;
  bool any = false, by_choice = false;

  /// True if an edge may lie between the centres of these two neighbouring pixels.
  bool parted_from(const Glimpse& o) const {
    if (any != o.any || object != o.object) return true;
    if (!any) return false;
    return dot(normal, o.normal) < 0.9f || std::abs(dot(normal, o.position - position)) > 2 * footprint;
  }
};

/// Pixels at edges. If two pixels that share a side show different surfaces (parted_from), both are edge pixels. A
/// pixel whose path chose one of several directions at a surface (SeenPoint::by_choice) is an edge pixel, too.
std::vector<std::size_t> edge_pixels(const std::vector<Glimpse>& glimpses, int width, int height) {
  std::vector<std::uint8_t> edge(glimpses.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      if (glimpses[at].by_choice) edge[at] = 1;
      if (x + 1 < width && glimpses[at].parted_from(glimpses[at + 1])) edge[at] = edge[at + 1] = 1;
      const std::size_t below = at + std::size_t(width);
      if (y + 1 < height && glimpses[at].parted_from(glimpses[below])) edge[at] = edge[below] = 1;
    }
  std::vector<std::size_t> pixels;
  for (std::size_t p = 0; p < edge.size(); ++p)
    if (edge[p]) pixels.push_back(p);
  return pixels;
}

/// Adds the variance and the noise of a record that was gathered twice to `counts`. Both are weighted as a viewer sees
/// errors: by the squared slope of the sRGB curve, which is proportional to level^(-7/6). Errors of gradients do not
/// count: with them, at the mean distance of interpolation, the estimated noise of a hut's picture was 1.12 times the
/// difference of two seeds, and 1.02 times without them.
void compare(const IrradianceRecord& once, const IrradianceRecord& again, GatherCounts& counts) {
  const Rgbd a(once.irradiance), b(again.irradiance), n(once.noise), m(again.noise);
  const double level = channel_mean(a + b);
  if (!(level > 0)) return;
  const double seen = std::pow(level, -7.0 / 6) / 2;
  counts.twice_variance += seen * channel_mean((a - b) * (a - b));
  counts.twice_noise += seen * channel_mean(n * n + m * m);
}

/// Adds records at points that are not yet covered.
class Placement {
 public:
  Placement(const FinalGather& gather, const RecordPicture& picture, const PlacementOptions& options,
            RecordStore& store, GatherCounts& counts)
      : gather_(gather),
        again_(gather.with_seed(gather.seed() ^ 0x616761696eull)),
        view_(picture.view),
        options_(options),
        store_(store),
        counts_(counts),
        source_(picture.source) {}

  /// Covers the points of `pixels`, in a fixed shuffled order. look(pixel) returns the raster position of a pixel;
  /// note(pixel, seen) receives its point. checked: every fourth point is gathered twice.
  template <class LookAt, class Note>
  void cover(const std::vector<std::size_t>& pixels, bool checked, const LookAt& look, const Note& note) {
    // A covered point stays covered, so only points that are open here are sorted and tested again, batch by batch.
    std::vector<Open> open = parallel_found<Open>(pixels.size(), 1024, [&](std::size_t i, std::vector<Open>& found) {
      const std::optional<SeenPoint> seen = view_(look(pixels[i]));
      if (!seen) return;
      note(pixels[i], *seen);
      if (!is_covered(*seen)) found.push_back({mix64(pixels[i]), pixels[i], *seen});
    });
    std::sort(open.begin(), open.end(),
              [](const Open& a, const Open& b) { return a.key != b.key ? a.key < b.key : a.pixel < b.pixel; });
    for (std::size_t start = 0; start < open.size(); start += kPlacedTogether)
      add_batch(std::span(open).subspan(start, std::min(kPlacedTogether, open.size() - start)), checked && !source_);
  }

 private:
  struct Open {
    std::uint64_t key;  ///< sort key: hash of the pixel
    std::size_t pixel;
    SeenPoint seen;
  };

  bool is_covered(const SeenPoint& seen) const {
    return store_.covers(seen.surface.position, seen.normal, options_.min_weight);
  }

  IrradianceRecord gathered(const FinalGather& gather, const SeenPoint& seen, GatherCounts& counts) const {
    IrradianceRecord record = gather.gather(seen.surface, seen.normal, counts);
    limit_radius(record, seen.footprint, options_);
    return record;
  }

  void add_batch(std::span<const Open> points, bool checked) {
    std::vector<std::optional<IrradianceRecord>> records(points.size()), again(points.size());
    counts_ += parallel_sum<GatherCounts>(points.size(), 8, [&](std::size_t i, GatherCounts& counts) {
      const SeenPoint& seen = points[i].seen;
      if (is_covered(seen)) return;
      if (source_) {
        records[i] = source_->gather(seen, i, counts);
        return;
      }
      records[i] = gathered(gather_, seen, counts);
      if (checked && i % kCheckedOneIn == 0) again[i] = gathered(again_, seen, counts);
      gather_.look_around(seen.surface, *records[i]);
    });
    for (std::size_t i = 0; i < records.size(); ++i)
      if (records[i] && store_.add(*records[i])) {
        if (source_ && source_->added) source_->added(i);
        if (again[i]) compare(*records[i], *again[i], counts_);
      }
  }

  static constexpr std::size_t kCheckedOneIn = 4;  ///< one record in this many is gathered twice
  const FinalGather& gather_;
  const FinalGather again_;
  const PixelView& view_;
  const PlacementOptions& options_;
  RecordStore& store_;
  GatherCounts& counts_;
  const RecordSource* source_;
};

/// The radius [m] before min_radius_px is applied.
float radius_by_distances(const IrradianceRecord& record, float footprint, const PlacementOptions& options) {
  return std::isinf(record.radius_unclamped) ? options.unseen_radius_px * footprint
                                             : options.error_bound * record.radius_unclamped;
}

}  // namespace

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

std::size_t place_records(const FinalGather& gather, const RecordPicture& picture, const PlacementOptions& options,
                          RecordStore& store, GatherCounts& counts) {
  const int width = picture.width, height = picture.height;
  const std::size_t before = store.records().size();
  Placement placement(gather, picture, options, store, counts);
  std::vector<Glimpse> glimpses(std::size_t(width) * std::size_t(height));
  std::size_t done = 0;
  const auto advance = [&](std::size_t pixels) {
    done += pixels;
    if (picture.progress) picture.progress(double(done) / (2 * double(width) * height));
  };
  const auto look_at = [&](std::size_t pixel, Vec2 within) {
    return Look{float(pixel % std::size_t(width)) + within.x, float(pixel / std::size_t(width)) + within.y, {}};
  };
  for (int stride = kCoarsest; stride >= 1; stride /= 2) {
    const std::vector<std::size_t> pixels = lattice(width, height, stride);
    placement.cover(
        pixels, stride == kCoarsest,
        [&](std::size_t pixel) {
          return look_at(pixel, {0.5f, 0.5f});
        },
        [&](std::size_t pixel, const SeenPoint& seen) {
          glimpses[pixel] = {seen.surface.position, seen.normal, seen.footprint,
                             seen.surface.object,   true,        seen.by_choice};
        });
    advance(pixels.size());
  }
  const std::vector<std::size_t> edges = edge_pixels(glimpses, width, height);
  constexpr Vec2 kWithin[4] = {{0.125f, 0.625f}, {0.375f, 0.125f}, {0.625f, 0.875f}, {0.875f, 0.375f}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    const auto look = [&](std::size_t pixel) {
      Look at = look_at(pixel, kWithin[k]);
      at.random.emplace(mix64(pixel), k);
      return at;
    };
    placement.cover(edges, false, look, [](std::size_t, const SeenPoint&) {});
    advance(edges.size() / 4);
  }
  store.complete_noise(before,
                       counts.twice_noise > 0 ? float(std::sqrt(counts.twice_variance / counts.twice_noise)) : 1.0f);
  return store.records().size() - before;
}

}  // namespace tempolux
