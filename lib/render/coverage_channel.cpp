#include "lib/render/data_channels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/parallel_each.h"
#include "lib/image/channel_groups.h"
#include "lib/image/pixel_surfaces.h"
#include "lib/render/shutter.h"

namespace tempolux {
namespace {

constexpr std::size_t kRays = 16;                          ///< per pixel that sees several surfaces
constexpr std::size_t kAround = 9, kCentre = 4;            ///< a pixel among the 3 x 3 pixels around it, in rows
constexpr std::size_t kOther = 9;                          ///< index of surfaces that none of the nine centres sees
constexpr std::size_t kSearch = 8;                         ///< rays per pixel that search for such surfaces
constexpr std::uint64_t kPattern = 0x636f766572616765ull;  ///< key of the rays' places, equal for all pixels and frames
constexpr std::uint64_t kBlurred = 0x626c757272656421ull;  ///< key of the random numbers of soft_edges()

/// The surface that a ray meets first.
struct Seen {
  std::uint32_t object = kNone, material = kNone;
  Vec3 position, normal;
  float footprint = 0;  ///< m: width of a pixel at the hit

  /// True if `other` may lie on the same smooth surface: it has the same object, material and nearly the same normal,
  /// and it lies within a pixel's width of the plane through this place.
  bool same_as(const Seen& other) const {
    if (object == kNone || other.object == kNone) return object == other.object;
    return object == other.object && material == other.material &&
           dot(normal, other.normal) > PixelSurfaces::kSameNormal &&
           std::abs(dot(normal, other.position - position)) < footprint;
  }
};

Seen seen_at(const SurfacePoint& point, const Ray& ray, float footprint) {
  return {point.object, point.material, point.position,
          dot(point.normal, ray.direction) > 0 ? -point.normal : point.normal, footprint};
}

class PixelCoverage {
 public:
  PixelCoverage(const RenderScene& scene, const CameraView& view)
      : scene_(scene),
        view_(view),
        width_(std::size_t(view.width())),
        centres_(width_ * std::size_t(view.height())),
        mixed_(centres_.size()) {
    for (std::size_t r = 0; r < kRays; ++r) spread_[r] = sobol_owen_2d(std::uint32_t(r), kPattern);
    parallel_chunks(centres_.size(), 1024, [&](std::size_t first, std::size_t last) {
      const auto rays_at = [&](Vec2 place) {
        std::vector<Vec2> places;
        for (std::size_t p = first; p < last; ++p)
          places.push_back({float(p % width_) + place.x, float(p / width_) + place.y});
        return CameraRays(scene_.tracer, view_, places);
      };
      const CameraRays middle = rays_at({0.5f, 0.5f});
      for (std::size_t p = first; p < last; ++p) centres_[p] = seen(middle, p - first);
      for (std::size_t r = 0; r < kSearch; ++r) {
        const CameraRays beside = rays_at(spread_[r]);
        for (std::size_t p = first, i = 0; p < last; ++p, ++i)
          mixed_[p] |= !(beside.hits[i].surface == middle.hits[i].surface &&
                         beside.hits[i].triangle == middle.hits[i].triangle) &&
                       !centres_[p].same_as(seen(beside, i));
      }
    });
  }

  struct Counts {
    std::uint32_t around = 0, other = 0;  ///< values of the channels "coverage" and "coverage.other"
  };
  Counts at(int x, int y) const {
    if (!is_edge(x, y)) return {};
    std::array<Vec2, kRays> places;
    for (std::size_t r = 0; r < kRays; ++r) places[r] = {float(x) + spread_[r].x, float(y) + spread_[r].y};
    const CameraRays rays(scene_.tracer, view_, places);
    std::array<std::uint32_t, kAround + 1> count{};
    for (std::size_t r = 0; r < kRays; ++r) ++count[nearest(x, y, spread_[r], seen(rays, r))];
    std::uint32_t packed = 0, bit = 0;
    for (std::size_t n = 0; n < kAround; ++n) {
      if (n == kCentre) continue;
      packed |= std::min(count[n], 15u) << bit;
      bit += 4;
    }
    return {packed, count[kOther]};
  }

 private:
  Seen seen(const CameraRays& rays, std::size_t i) const {
    const Hit& hit = rays.hits[i];
    if (hit.surface == kNone) return {};
    return seen_at(scene_.tracer.surface_point(hit), rays.rays[i], view_.pixel_size(hit.t));
  }

  /// The surface at the centre of pixel `around` of the 3 x 3 pixels around (x, y); nullptr outside the picture.
  const Seen* centre(int x, int y, std::size_t around) const {
    x += int(around % 3) - 1;
    y += int(around / 3) - 1;
    return x < 0 || y < 0 || x >= view_.width() || y >= view_.height()
               ? nullptr
               : &centres_[std::size_t(y) * width_ + std::size_t(x)];
  }

  bool is_edge(int x, int y) const {
    if (mixed_[std::size_t(y) * width_ + std::size_t(x)]) return true;
    const Seen& own = *centre(x, y, kCentre);
    for (std::size_t n = 0; n < kAround; ++n)
      if (const Seen* other = centre(x, y, n); other && !(own.same_as(*other) && other->same_as(own))) return true;
    return false;
  }

  /// The pixel whose surface `ray` meets: kCentre, or else the neighbour whose centre is closest to the ray's `place`
  /// in the pixel, in [0, 1)^2; kOther if it is the surface of none of the nine.
  std::size_t nearest(int x, int y, Vec2 place, const Seen& ray) const {
    if (centre(x, y, kCentre)->same_as(ray)) return kCentre;
    std::size_t best = kOther;
    float best_distance2 = 8;
    for (std::size_t n = 0; n < kAround; ++n) {
      const Seen* other = centre(x, y, n);
      if (n == kCentre || !other || !other->same_as(ray)) continue;
      const float dx = float(int(n % 3) - 1) + 0.5f - place.x, dy = float(int(n / 3) - 1) + 0.5f - place.y;
      const float distance2 = dx * dx + dy * dy;
      if (distance2 < best_distance2) {
        best_distance2 = distance2;
        best = n;
      }
    }
    return best;
  }

  const RenderScene& scene_;
  const CameraView& view_;
  std::size_t width_;
  std::array<Vec2, kRays> spread_;
  std::vector<Seen> centres_;
  std::vector<std::uint8_t> mixed_;  ///< by pixel; 1: another ray meets another surface than the centre's ray
};

/// Returns what a sample of a blurred picture meets. Place and normal are those at the frame's time, so that a moving
/// surface is one surface at all moments.
Seen seen_in(const SeenNow& now, const CameraSample& sample) {
  const Ray ray = now.view.ray(sample);
  Hit hit;
  if (!now.scene.tracer.intersect(ray, hit)) return {};
  const SurfacePoint point = now.scene.tracer.surface_point(hit);
  Seen seen = seen_at(point, ray, now.view.pixel_size(hit.t));
  if (now.scene.stored) {
    const StoredPlaces::Place then = now.scene.stored->of(point, point.normal_geometric, seen.normal);
    seen.position = then.surface.position;
    seen.normal = then.shading;
  }
  return seen;
}

}  // namespace

std::vector<std::uint8_t> soft_edges(const RenderScene& scene, const CameraView& view, const Shutter* shutter) {
  std::vector<std::uint8_t> edges(std::size_t(view.width()) * std::size_t(view.height()));
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    Seen first;
    for (std::uint32_t r = 0; r < kSearch && !edges[p]; ++r) {
      const PixelRandom random(kBlurred, p, r);
      const SeenNow now = seen_now({scene, view}, shutter, random);
      const Seen seen = seen_in(now, sample_of_pixel(now.view, x, y, random));
      if (r == 0) first = seen;
      else edges[p] = !first.same_as(seen);
    }
  });
  return edges;
}

std::vector<std::uint8_t> add_coverage_channel(const RenderScene& scene, const CameraView& view,
                                               const std::vector<std::string>& channels, Image& image) {
  std::vector<std::uint8_t> edges;
  if (!asked(channels, "coverage")) return edges;
  edges.resize(image.pixel_count());
  std::uint32_t* const around = image.add_ids("coverage").ids.data();
  std::uint32_t* const other = image.add_ids("coverage.other").ids.data();
  const PixelCoverage pixels(scene, view);
  parallel_pixels(view.width(), view.height(), [&](int x, int y, std::size_t p) {
    const PixelCoverage::Counts counts = pixels.at(x, y);
    around[p] = counts.around;
    other[p] = counts.other;
    edges[p] = counts.around != 0 || counts.other != 0;
  });
  return edges;
}

}  // namespace tempolux
