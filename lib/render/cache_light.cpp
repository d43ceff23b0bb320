#include "lib/render/cache_light.h"

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

std::optional<SeenPoint> seen_through(const Tracer& tracer, const CameraView& view, float x, float y, const PathRandom* random) {
  Ray ray = view.ray(x, y);
  float distance = 0;
  for (std::uint32_t mirrors = 0; mirrors < kMirrorsInARow; ++mirrors) {
    Hit hit;
    if (!tracer.intersect(ray, hit)) return std::nullopt;
    SurfacePoint point = tracer.surface_point(hit);
    distance += hit.t;
    const SurfaceMaterial material(tracer.frame(), point, view.pixel_size(distance));
    const ShadingPoint shading(point, -ray.direction, material);
    if (shading.bsdf.has_diffuse()) {
      // Size of a pixel there: the angle to the neighbouring pixel's ray times the whole way.
      const float step = view.pixel_size(distance);
      return SeenPoint{point, shading.normal, step, mirrors > 0};
    }
    // u = 0.5 follows what is more than half of the light.
    const float lobe = random ? random->get1(mirrors, Purpose::lobe) : 0.5f;
    const Vec2 within = random ? random->get2(mirrors, Purpose::scatter) : Vec2{0.5f, 0.5f};
    const Bsdf::Sample next = shading.bsdf.sample(shading.wo_local, lobe, within);
    if (is_black(next.weight)) return std::nullopt;
    ray = spawn_ray(point, shading.frame.to_world(next.wi));
  }
  return std::nullopt;
}

}  // namespace tempolux
