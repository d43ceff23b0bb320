#include "lib/transport/media.h"

#include "lib/core/sampling.h"
#include "lib/material/bsdf.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {

float media_transmittance(const Media& media, const Ray& ray, const WayBits& bits) {
  const float size = length(ray.direction);
  if (!(size > 0)) return 1;
  const Vec3 unit = ray.direction / size;
  return estimate_transmittance(media, ray.origin + ray.direction * ray.t_min, unit, (ray.t_max - ray.t_min) * size,
                                bits);
}

Rgb passed_straight(const SceneFrame& frame, SurfacePoint point, Vec3 direction) {
  if (!(point.plate > 0) && !may_be_pane(frame.materials[point.material])) return Rgb(0.0f);
  const SurfaceMaterial material(frame, point);
  const Vec3 wo = -normalize(direction);
  return Bsdf(material, dot(point.normal_geometric, wo) > 0, point.plate)
      .passed_straight(SeenSide(point, wo).wo_local.z);
}

namespace {

/// Share of light that the surfaces on the way pass straight: that of all panes, or black for any other surface.
Rgb passed_surfaces(const Tracer& tracer, Ray ray) {
  if (!tracer.has_panes()) return Rgb(tracer.occluded(ray) ? 0.0f : 1.0f);
  Rgb passed(1.0f);
  for (Hit hit; tracer.intersect(ray, hit);) {
    if (!tracer.may_pass(hit)) return Rgb(0.0f);
    const SurfacePoint point = tracer.surface_point(hit);
    passed *= passed_straight(tracer.frame(), point, ray.direction);
    if (is_black(passed)) break;
    pass_surface(point, hit.t, ray);
  }
  return passed;
}

}  // namespace

Rgb transmittance(const Tracer& tracer, const Ray& ray, const WayBits& bits) {
  const Rgb passed = passed_surfaces(tracer, ray);
  const Media* const media = tracer.frame().media.get();
  return media && !is_black(passed) ? passed * media_transmittance(*media, ray, bits) : passed;
}

bool collides(const Media& media, const Ray& ray, float end, const PathRandom& random, std::uint32_t bounce,
              MediumPoint& point) {
  const float t = first_collision(media, ray.origin, ray.direction, end, WayBits{random, bounce, way_path});
  if (t == INFINITY) return false;
  point.position = ray.origin + ray.direction * t;
  point.travel = ray.direction;
  const MediumOptions& options = media.collided(point.position, random.get1(bounce, Purpose::medium)).options();
  point.albedo = options.albedo;
  point.g = options.g;
  return true;
}

Rgb scattered_lamp_light(const Tracer& tracer, const Lights& lights, const MediumPoint& point, const LampDraw& draw,
                         std::uint64_t& shadow_rays) {
  LightSample light;
  if (!lights.sample(point.position, {}, draw.u, light)) return Rgb(0.0f);
  // Light travels against the direction of the path, so the peak of the phase function lies ahead along the path.
  const float phase = pdf_hg(point.g, point.travel, light.wi);
  Rgb radiance = light.facing_irradiance * phase;
  if (draw.weigh && !light.only_sampled) radiance *= mis_power(light.pdf_solid_angle, phase);
  if (is_black(radiance)) return radiance;
  ++shadow_rays;
  SurfacePoint from{};  // without an offset, because there is no surface in a medium
  from.position = point.position;
  return radiance * transmittance(tracer, spawn_shadow_ray(from, light.position, light.position_offset), draw.bits);
}

}  // namespace tempolux
