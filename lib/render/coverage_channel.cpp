#include "lib/render/coverage_channel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/image/pixel_surfaces.h"

namespace tempolux {
namespace {

constexpr std::size_t kRays = 16, kAround = 9, kCentre = 4;
constexpr std::uint64_t kPattern = 0x636f766572616765ull;   // one pattern of rays for all pixels and frames

/// What a ray meets.
struct Seen {
  std::uint32_t object = kNone;
  Vec3 position, normal;
  float footprint = 0;   ///< m: a pixel's width there

  /// Is `other` a place of the same smooth surface, about a pixel away? Its plane passes it within a pixel's width.
  bool same_as(const Seen& other) const {
    if (object == kNone || other.object == kNone) return object == other.object;
    return object == other.object && dot(normal, other.normal) > PixelSurfaces::kSameNormal &&
           std::abs(dot(normal, other.position - position)) < footprint;
  }
};

class PixelCoverage {
 public:
  PixelCoverage(const RenderScene& scene, const CameraView& view) : scene_(scene), view_(view) {
    for (std::size_t r = 0; r < kRays; ++r) spread_[r] = sobol_owen_2d(std::uint32_t(r), kPattern);
  }

  std::uint32_t at(int x, int y) const {
    std::array<Vec2, kAround> centres;
    for (std::size_t n = 0; n < kAround; ++n) centres[n] = {0.5f + float(int(n % 3) - 1), 0.5f + float(int(n / 3) - 1)};
    std::array<Seen, kAround> around;
    std::array<Seen, kRays> rays;
    look(x, y, centres, around);
    look(x, y, spread_, rays);
    std::array<std::uint32_t, kAround> count{};
    for (std::size_t r = 0; r < kRays; ++r) ++count[nearest(x, y, spread_[r], rays[r], centres, around)];
    std::uint32_t packed = 0, bit = 0;
    for (std::size_t n = 0; n < kAround; ++n) {
      if (n == kCentre) continue;
      packed |= std::min(count[n], 15u) << bit;
      bit += 4;
    }
    return packed;
  }

 private:
  /// places: within the pixel, [0, 1) each way, or outside it.
  void look(int x, int y, std::span<const Vec2> places, std::span<Seen> seen) const {
    constexpr std::size_t kTogether = 8;   // a packet
    std::array<Ray, kTogether> rays;
    std::array<Hit, kTogether> hits;
    for (std::size_t first = 0; first < places.size(); first += kTogether) {
      const std::size_t count = std::min(kTogether, places.size() - first);
      for (std::size_t i = 0; i < count; ++i) rays[i] = view_.ray(float(x) + places[first + i].x, float(y) + places[first + i].y);
      for (std::size_t i = 0; i < count; ++i) hits[i] = {};
      scene_.tracer.intersect(std::span(rays).first(count), std::span(hits).first(count));
      for (std::size_t i = 0; i < count; ++i) {
        if (hits[i].surface == kNone) continue;
        const SurfacePoint point = scene_.tracer.surface_point(hits[i]);
        seen[first + i] = {point.object, point.position, dot(point.normal, rays[i].direction) > 0 ? -point.normal : point.normal,
                           view_.pixel_size(hits[i].t)};
      }
    }
  }

  /// Which pixel's surface a ray meets: the pixel's own, else that of the nearest one around that lies in the picture.
  std::size_t nearest(int x, int y, Vec2 place, const Seen& ray, std::span<const Vec2> centres, std::span<const Seen> around) const {
    if (around[kCentre].same_as(ray)) return kCentre;
    std::size_t best = kCentre;
    float best_distance2 = 8;
    for (std::size_t n = 0; n < kAround; ++n) {
      const int nx = x + int(n % 3) - 1, ny = y + int(n / 3) - 1;
      if (n == kCentre || nx < 0 || ny < 0 || nx >= view_.width() || ny >= view_.height() || !around[n].same_as(ray)) continue;
      const float dx = centres[n].x - place.x, dy = centres[n].y - place.y, distance2 = dx * dx + dy * dy;
      if (distance2 < best_distance2) {
        best_distance2 = distance2;
        best = n;
      }
    }
    return best;
  }

  const RenderScene& scene_;
  const CameraView& view_;
  std::array<Vec2, kRays> spread_;
};

}  // namespace

void add_coverage_channel(const RenderScene& scene, const CameraView& view, const std::vector<std::string>& channels, Image& image) {
  if (std::find(channels.begin(), channels.end(), "coverage") == channels.end()) return;
  if (!image.find("Z") || !image.find("N.X") || !image.find("id.object"))
    throw InputError("--channels coverage: needs Z, N and id beside it; add them");
  const std::vector<std::uint8_t> edges = PixelSurfaces(image).edges();
  std::vector<std::uint32_t>& coverage = image.add_ids("coverage").ids;
  const PixelCoverage pixels(scene, view);
  parallel_chunks(edges.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p)
      if (edges[p]) coverage[p] = pixels.at(int(p % std::size_t(view.width())), int(p / std::size_t(view.width())));
  });
}

}  // namespace tempolux
