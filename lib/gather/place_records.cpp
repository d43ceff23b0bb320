#include "lib/gather/place_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace tempolux {
namespace {

constexpr int kCoarsest = 16;
constexpr float kFewCells = 8, kEnoughCells = 32;   ///< lit cells: gradients are left out; count in full
constexpr float kWideLight = 0.6f;   ///< share of the hemisphere

/// Pixels of the lattice of `stride` that are on no coarser one (of 1: all), row by row.
std::vector<std::size_t> lattice(int width, int height, int stride) {
  std::vector<std::size_t> pixels;
  for (int y = 0; y < height; y += stride)
    for (int x = 0; x < width; x += stride) {
      if (stride > 1 && stride < kCoarsest && x % (2 * stride) == 0 && y % (2 * stride) == 0) continue;
      pixels.push_back(std::size_t(y) * std::size_t(width) + std::size_t(x));
    }
  return pixels;
}

/// What a pixel saw, in short.
struct Glimpse {
  Vec3 position, normal;
  float footprint = 0;
  std::uint32_t object = 0;
  bool any = false, by_choice = false;

  /// Could something else lie between this pixel's centre and its neighbour's?
  bool parted_from(const Glimpse& o) const {
    if (any != o.any || object != o.object) return true;
    if (!any) return false;
    return dot(normal, o.normal) < 0.9f || std::abs(dot(normal, o.position - position)) > 2 * footprint;
  }
};

/// Pixels that differ from one beside or below them, both; and those seen by choice.
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

/// Adds records at points that none covers yet.
class Placement {
 public:
  Placement(const FinalGather& gather, const PixelViews& views, const PlacementOptions& options,
            RecordStore& store, GatherCounts& counts, const RecordSource* source)
      : gather_(gather),
        views_(views),
        options_(options),
        store_(store),
        first_(store.records().size()),
        counts_(counts),
        source_(source) {}

  /// From now on a new record leaves its neighbours as they are: what is covered stays so.
  void fix_radii() { first_ = kFixed; }

  /// Points of pixels, in a fixed shuffled order. look(pixel): where to look, if anywhere; note(pixel, seen): what was
  /// seen.
  template <class LookAt, class Note>
  void cover(const std::vector<std::size_t>& pixels, const LookAt& look, const Note& note) {
    // What is covered now stays covered: only the rest is put into order and looked at again, batch by batch.
    constexpr std::size_t kChunk = 1024;
    std::vector<std::vector<Open>> found((pixels.size() + kChunk - 1) / kChunk);
    parallel_chunks(pixels.size(), kChunk, [&](std::size_t first, std::size_t last) {
      std::array<Look, kLooksTogether> looks;
      std::array<std::size_t, kLooksTogether> of;
      std::array<std::optional<SeenPoint>, kLooksTogether> seen;
      std::size_t count = 0;
      const auto see = [&] {
        views_(std::span(looks).first(count), std::span(seen).first(count));
        for (std::size_t k = 0; k < count; ++k) {
          if (!seen[k]) continue;
          note(of[k], *seen[k]);
          if (!is_covered(*seen[k])) found[first / kChunk].push_back({mix64(of[k]), of[k], *seen[k]});
        }
        count = 0;
      };
      for (std::size_t i = first; i < last; ++i) {
        const std::optional<Look> at = look(pixels[i]);
        if (!at) continue;
        looks[count] = *at;
        of[count] = pixels[i];
        if (++count == kLooksTogether) see();
      }
      if (count > 0) see();
    });
    std::vector<Open> open;
    for (const auto& some : found) open.insert(open.end(), some.begin(), some.end());
    std::sort(open.begin(), open.end(), [](const Open& a, const Open& b) { return a.key != b.key ? a.key < b.key : a.pixel < b.pixel; });
    for (std::size_t start = 0; start < open.size(); start += kPlacedTogether)
      add_batch(std::span(open).subspan(start, std::min(kPlacedTogether, open.size() - start)));
  }

  bool is_covered(Vec3 position, Vec3 normal, float footprint) const {
    return store_.covers(position, normal, options_.min_weight, options_.min_radius_px * footprint);
  }

 private:
  static constexpr std::size_t kFixed = ~std::size_t(0);
  struct Open {
    std::uint64_t key;   ///< what it is sorted by
    std::size_t pixel;
    SeenPoint seen;
  };

  bool is_covered(const SeenPoint& seen) const { return is_covered(seen.surface.position, seen.normal, seen.footprint); }

  void add_batch(std::span<const Open> points) {
    std::vector<std::optional<IrradianceRecord>> records(points.size());
    std::mutex mutex;
    parallel_chunks(points.size(), 8, [&](std::size_t first, std::size_t last) {
      GatherCounts local;
      for (std::size_t i = first; i < last; ++i) {
        const SeenPoint& seen = points[i].seen;
        if (is_covered(seen)) continue;
        std::optional<RecordStore::Expected> expected = store_.expected(seen.surface.position, seen.normal);
        if (!expected) expected = RecordStore::Expected{gather_.lit_share(seen.surface, seen.normal, local), 0};
        if (source_) {
          records[i] = source_->gather(seen, *expected, i, local);
          continue;
        }
        records[i] = gather_.gather(seen.surface, seen.normal, local, expected->lit_share);
        limit_radius(*records[i], seen.footprint, options_);
        gather_.look_around(seen.surface, *records[i]);
      }
      const std::lock_guard lock(mutex);
      counts_ += local;
    });
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (!records[i]) continue;
      if (options_.clamp_neighbours) store_.clamp_with_neighbours(*records[i], options_.error_bound, first_);
      if (store_.add(*records[i]) && source_) source_->added(i, first_);
    }
  }

  const FinalGather& gather_;
  const PixelViews& views_;
  const PlacementOptions& options_;
  RecordStore& store_;
  std::size_t first_;        ///< records before were there already, or are fixed
  GatherCounts& counts_;
  const RecordSource* source_;
};

}  // namespace

void limit_radius(IrradianceRecord& record, float footprint, const PlacementOptions& options) {
  // double: squares of gradients, whatever the strength of the light, stay finite, and its power of two changes no radius.
  const double e = channel_sum(Rgbd(record.irradiance));
  // Of light that a handful of rays found gradients say nothing. Were they to shrink the radius, records whose rays missed
  // that light would outweigh those that met it: a small bright thing over a wide floor came out 75 % dark.
  const float trust = std::clamp((record.lit_cells - kFewCells) / (kEnoughCells - kFewCells), 0.0f, 1.0f);
  for (Vec3& g : record.translational) g *= trust;
  for (Vec3& g : record.rotational) g *= trust;
  if (record.expected_share > 0) record.radius_unclamped *= std::min(1.0f, std::sqrt(record.expected_share / kWideLight));
  double reach = double(record.radius_unclamped), slope = 0;
  for (Vec3 g : record.translational) slope += length(Vec3d(g));
  if (slope * reach > e && slope > 0) reach = e / slope;
  const float r = std::min(std::isfinite(reach) ? options.error_bound * float(reach) : options.unseen_radius_px * footprint, record.radius);
  record.radius_unclamped *= options.error_bound;
  record.radius = std::max(r, options.min_radius_px * footprint);
  // Near a wall the gradient is large, noisy, and holds over a part of this radius only [Jakob, Mitsuba 0.6].
  if (r < record.radius)
    for (Vec3& g : record.translational) g *= r / record.radius;
  slope *= double(r / record.radius);
  // A gradient steeper than the irradiance over the smallest radius would extrapolate below zero.
  const double over = slope * double(record.radius);
  if (over > e && slope > 0)
    for (Vec3& g : record.translational) g *= float(e / over);
}

std::size_t place_records(const FinalGather& gather, const PixelViews& views, int width, int height,
                          const PlacementOptions& options, RecordStore& store, GatherCounts& counts,
                          const std::function<void(double)>& progress, const RecordSource* source) {
  const std::size_t before = store.records().size();
  Placement placement(gather, views, options, store, counts, source);
  std::vector<Glimpse> glimpses(std::size_t(width) * std::size_t(height));
  std::size_t done = 0;
  const auto advance = [&](std::size_t pixels) {
    done += pixels;
    if (progress) progress(double(done) / (1.25 * double(width) * height));
  };
  for (int stride = kCoarsest; stride >= 1; stride /= 2) {
    if (stride == 1) placement.fix_radii();   // and look again at what was covered before
    const std::vector<std::size_t> pixels = lattice(width, height, stride);
    const auto look = [&](std::size_t pixel) -> std::optional<Look> {
      const Glimpse& known = glimpses[pixel];
      if (known.any && placement.is_covered(known.position, known.normal, known.footprint)) return std::nullopt;
      return Look{float(pixel % std::size_t(width)) + 0.5f, float(pixel / std::size_t(width)) + 0.5f, {}};
    };
    placement.cover(pixels, look, [&](std::size_t pixel, const SeenPoint& seen) {
      glimpses[pixel] = {seen.surface.position, seen.normal, seen.footprint, seen.surface.object, true, seen.by_choice};
    });
    advance(pixels.size());
  }
  const std::vector<std::size_t> edges = edge_pixels(glimpses, width, height);
  constexpr Vec2 kWithin[4] = {{0.125f, 0.625f}, {0.375f, 0.125f}, {0.625f, 0.875f}, {0.875f, 0.375f}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    const auto look = [&](std::size_t pixel) -> std::optional<Look> {
      return Look{float(pixel % std::size_t(width)) + kWithin[k].x, float(pixel / std::size_t(width)) + kWithin[k].y,
                  PathRandom(mix64(pixel), k)};
    };
    placement.cover(edges, look, [](std::size_t, const SeenPoint&) {});
    advance(std::size_t(width) * std::size_t(height) / 16);
  }
  return store.records().size() - before;
}

}  // namespace tempolux
