#include "lib/render/cache_light.h"

#include <array>

#include "lib/core/parallel.h"
#include "lib/render/shading.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kMirrorsInARow = 16;

}  // namespace

DiffuseLight::Irradiance CacheLight::at(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, bool direct_view,
                                        const Rgb* caustic) const {
  Irradiance result;
  if (caustic) result.caustic = *caustic;
  else if (photons_) result.caustic = photons_->caustic(surface.position, geometric, result.sparse_radius);
  RecordStore::Interpolated found = records_.interpolate(surface.position, shading);
  if (!(found.weight > 0) && direct_view) found = records_.interpolate_relaxed(surface.position, shading);
  if (found.weight > 0) {
    result.indirect = found.irradiance;
  } else {
    missing_.fetch_add(1, std::memory_order_relaxed);
    std::call_once(gather_made_, [&] { run_isolated([&] { gather_ = make_gather_(); }); });
    GatherCounts counts;
    if (gather_) result.indirect = gather_->gather(surface, shading, counts).irradiance;
  }
  return result;
}

namespace {

std::optional<SeenPoint> follow(const Tracer& tracer, const CameraView& view, const Look& look, Ray ray, Hit hit) {
  float distance = 0;
  for (std::uint32_t mirrors = 0; hit.surface != kNone; ++mirrors) {
    SurfacePoint point = tracer.surface_point(hit);
    distance += hit.t;
    const SurfaceMaterial material(tracer.frame(), point, view.pixel_size(distance));
    const ShadingPoint shading(point, -ray.direction, material);
    if (shading.bsdf.has_diffuse()) {
      // Size of a pixel there: the angle to the neighbouring pixel's ray times the whole way.
      const float step = view.pixel_size(distance);
      return SeenPoint{point, shading.normal, step, mirrors > 0};
    }
    if (mirrors + 1 == kMirrorsInARow) break;
    // u = 0.5 follows what is more than half of the light.
    const float lobe = look.random ? look.random->get1(mirrors, Purpose::lobe) : 0.5f;
    const Vec2 within = look.random ? look.random->get2(mirrors, Purpose::scatter) : Vec2{0.5f, 0.5f};
    const Bsdf::Sample next = shading.bsdf.sample(shading.wo_local, lobe, within);
    if (is_black(next.weight)) break;
    ray = spawn_ray(point, shading.frame.to_world(next.wi));
    hit = {};
    tracer.intersect(ray, hit);
  }
  return std::nullopt;
}

}  // namespace

void seen_through(const Tracer& tracer, const CameraView& view, std::span<const Look> looks,
                  std::span<std::optional<SeenPoint>> seen) {
  std::array<Ray, kLooksTogether> rays;
  std::array<Hit, kLooksTogether> hits;
  for (std::size_t i = 0; i < looks.size(); ++i) rays[i] = view.ray(looks[i].x, looks[i].y);
  tracer.intersect(std::span(rays).first(looks.size()), std::span(hits).first(looks.size()));
  for (std::size_t i = 0; i < looks.size(); ++i) seen[i] = follow(tracer, view, looks[i], rays[i], hits[i]);
}

}  // namespace tempolux
