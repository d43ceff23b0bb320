#include "lib/render/known_light.h"

#include "lib/light_texture/mesh_light.h"
#include "lib/material/inside.h"
#include "lib/render/localised_light.h"
#include "lib/render/shading.h"

namespace tempolux {

std::optional<Rgb> KnownLight::indirect(const SurfacePoint& surface, Vec3 geometric, Vec3 shading, Rgb* noise) const {
  if (mesh) return mesh->irradiance(surface, geometric);
  if (localised) return localised->at(surface, shading, noise);
  if (records) {
    const RecordStore::Interpolated found = records->interpolate(surface.position, shading);
    if (noise) *noise = found.noise;
    return found.weight > 0 ? std::optional(found.irradiance) : std::nullopt;
  }
  return photons && photons->has_indirect() ? std::optional(photons->indirect(surface.position, geometric))
                                            : std::nullopt;
}

std::optional<KnownLight::PointLight> KnownLight::point_light(const SurfacePoint& hit, Vec3 geometric, float distance,
                                                              float u) const {
  if (!points) return std::nullopt;
  const PointLookup::Light* light = points->find(hit.position, geometric);
  if (!light || !points->is_uniform_indirect(*light) || PointLookup::is_near(*light, distance, u)) return std::nullopt;
  if (points->is_uniform(*light)) return PointLight{light->all};
  const IrradiancePoint& point = points->point(*light);
  return PointLight{point.indirect + point.caustic, false};
}

float KnownLight::remaining_share(const SurfacePoint& hit, Vec3 geometric, float distance, float u) const {
  const PointLookup::Light* light = bright ? points->find(hit.position, geometric) : nullptr;
  return light && !PointLookup::is_near(*light, distance, u) ? bright->remaining_share(*light, distance) : 1.0f;
}

std::optional<SeenPoint> seen_through(const Tracer& tracer, const CameraView& view, const Look& look) {
  Ray ray = view.pinhole({look.x, look.y});
  Hit hit;
  tracer.intersect(ray, hit);
  float distance = 0;
  Rgb passed(1.0f);
  Inside inside;
  for (std::uint32_t mirrors = 0; hit.surface != kNone; ++mirrors) {
    SurfacePoint point = tracer.surface_point(hit);
    distance += hit.t;
    const SurfaceMaterial material(tracer.frame(), point, view.pixel_size(distance));
    const ShadingPoint shading(point, -ray.direction, material);
    const bool front = dot(point.normal_geometric, ray.direction) < 0;
    passed *= inside.transmittance_to(tracer.frame().materials, point.material, front, hit.t);
    if (shading.bsdf.has_diffuse()) {
      // Size of a pixel at the hit: the angle between the rays of neighbouring pixels times the length of the path.
      const float step = view.pixel_size(distance);
      return SeenPoint{point, shading.normal, step, mirrors > 0, passed};
    }
    if (mirrors + 1 == kMostMirrors) break;
    // u = 0.5 chooses the lobe that has more than half of the light.
    const float lobe = look.random ? look.random->get1(mirrors, Purpose::lobe) : 0.5f;
    const Vec2 within = look.random ? look.random->get2(mirrors, Purpose::scatter) : Vec2{0.5f, 0.5f};
    const Bsdf::Sample next = shading.bsdf.sample(shading.wo_local, lobe, within);
    if (is_black(next.weight)) break;
    passed *= next.weight;
    if (is_solid_glass(material)) inside.scatter(point.material, front, next.transmitted);
    ray = spawn_ray(point, shading.frame.to_world(next.wi));
    hit = {};
    tracer.intersect(ray, hit);
  }
  return std::nullopt;
}

}  // namespace tempolux
