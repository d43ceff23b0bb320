#include "lib/render/path_tracer.h"

#include <array>

#include "lib/core/check.h"
#include "lib/core/sampling.h"
#include "lib/gather/medium_event.h"
#include "lib/material/inside.h"
#include "lib/render/matte_ends.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kRouletteFrom = 3;     ///< bounces that always survive
constexpr float kLargestSurvival = 0.998f;     ///< so that paths in a lossless box end, after 500 bounces in the mean

/// The last scattering: what a hit on a light must know to weigh itself against light sampling.
struct LastScatter {
  bool weighed = false;                        ///< false: camera ray or delta lobe, light sampling could not find it
  Vec3 position, normal;                       ///< normal on the side that was scattered to
  float pdf_solid_angle = 0;
  float light_share = 1;                       ///< of light samples that were aimed at that side
};

/// Light sampling at x, told apart by the lobe that scatters it. [Veach 1997 (9.14)]
void add_sampled_light(const RenderScene& scene, const ShadingPoint& x, const Rgb& throughput, const EyePath& path,
                       const Inside& inside, const PixelRandom& random, std::uint32_t bounce, bool weigh_diffuse,
                       Layers& result, RayCounts& counts) {
  const bool specular = x.bsdf.has_specular() && !x.bsdf.specular_is_delta();
  if (!x.bsdf.has_diffuse() && !specular) return;
  // Rough glass passes on light from behind: the side is drawn, the other's light is left to other samples.
  const float share_beyond = x.bsdf.light_share_beyond();
  bool beyond = false;
  float share = 1;
  if (share_beyond > 0) [[unlikely]] {
    beyond = random.get1(bounce, Purpose::light_choice) < share_beyond;
    share = beyond ? share_beyond : 1 - share_beyond;
  }
  LightSample light;
  if (!scene.lights.sample(x.surface.position, beyond ? -x.normal : x.normal, random.get2(bounce, Purpose::light_point), light)) return;
  if (beyond ? !x.sees_beyond(light.wi) : !x.sees(light.wi)) return;
  const Vec3 wi = x.frame.to_local(light.wi);
  Rgb diffuse = x.bsdf.has_diffuse() ? x.bsdf.eval_diffuse(wi, x.wo_local) : Rgb(0.0f);
  Rgb glossy = specular ? x.bsdf.eval_specular(wi, x.wo_local) : Rgb(0.0f);
  if (!light.delta) {
    const float pdf = light.pdf_solid_angle * share;
    if (weigh_diffuse) diffuse *= mis_power(pdf, x.bsdf.pdf_diffuse(wi, x.wo_local));
    if (specular) glossy *= mis_power(pdf, x.bsdf.pdf_specular(wi, x.wo_local));
  }
  if (is_black(diffuse) && is_black(glossy)) return;
  ++counts.shadow;
  const Ray shadow = spawn_shadow_ray(x.surface, light.position, light.position_offset);
  if (scene.tracer.occluded(shadow)) return;
  Rgb arriving = throughput * light.radiance * (std::abs(wi.z) / share);
  if (const Media* const media = scene.frame().media.get()) [[unlikely]]
    arriving *= media_transmittance(*media, shadow, {random.hashed(), bounce, way_shadow});
  if (inside.any()) arriving *= inside.transmittance_over(scene.frame().materials, length(light.position - x.surface.position));
  result[path.after(true).layer()] += arriving * diffuse;
  result[path.after(false).layer()] += arriving * glossy;
}

/// Emission of the surface that was hit, weighed against light sampling from the scattering before.
/// Textures are read at their finest level where light sampling could have found the light: both read the same.
void add_emission(const RenderScene& scene, const SurfacePoint& hit, Vec3 wo, const LastScatter& last,
                  const Rgb& throughput, Layer layer, float width, Layers& result) {
  const Rgb emitted = scene.lights.emitted(hit, wo, last.weighed ? 0 : width);
  if (is_black(emitted)) return;
  const float weight = last.weighed ? mis_power(last.pdf_solid_angle,
                                                last.light_share *
                                                scene.lights.pdf_solid_angle(last.position, last.normal, hit.surface,
                                                                             hit.triangle, hit.position,
                                                                             hit.normal_geometric))
                                    : 1.0f;
  result[layer] += throughput * emitted * weight;
}

/// The environment where the ray leaves the scene, weighed likewise.
void add_environment(const RenderScene& scene, Vec3 direction, const LastScatter& last, const Rgb& throughput,
                     Layer layer, Layers& result) {
  const float weight =
      last.weighed ? mis_power(last.pdf_solid_angle, last.light_share * scene.lights.pdf_environment(
                                                                            last.position, last.normal, direction))
                   : 1.0f;
  result[layer] += throughput * scene.lights.environment(direction) * weight;
}

/// Scattering in a medium: light of a lamp, roulette, a new direction. False if the path ends there.
bool scatter_in_medium(const RenderScene& scene, const MediumPoint& point, const PixelRandom& random, std::uint32_t bounce,
                       EyePath& path, Rgb& throughput, LastScatter& last, Ray& ray, Layers& result, RayCounts& counts) {
  path.scatter_in_medium();
  throughput *= point.albedo;
  const WayBits bits{random.hashed(), bounce, way_shadow_of_medium};
  result[path.layer()] +=
      throughput * sampled_light(scene.tracer, scene.lights, point, random.get2(bounce, Purpose::light_point), true, bits, counts.shadow);
  if (bounce + 1 >= kRouletteFrom) {
    const float survival = std::min(kLargestSurvival, max_component(throughput));
    if (!(random.get1(bounce, Purpose::roulette) < survival)) return false;
    throughput *= 1 / survival;
  } else if (is_black(throughput)) {
    return false;
  }
  const Vec3 travel = sample_hg(point.g, point.travel, random.get2(bounce, Purpose::phase));
  last.weighed = true;
  last.position = point.position;
  last.normal = {};
  last.light_share = 1;
  last.pdf_solid_angle = pdf_hg(point.g, point.travel, travel);
  ray = {point.position, travel, 0, INFINITY};
  return true;
}

/// Follows a path; adds to `result`. With `end` it may end at a matte surface of which all but the light sampled there is
/// known: then that is set and the answer is true.
bool follow(const RenderScene& scene, const EyeRay& eye, const PixelRandom& random, const DiffuseLight* diffuse_light,
            RayCounts& counts, MatteEnd* end, Layers& result) {
  bool ends_matte = false;
  Rgb throughput{1.0f};
  EyePath path;
  Inside inside;
  LastScatter last;
  const SceneFrame& frame = scene.frame();
  RayCone cone = eye.cone;
  Ray ray = eye.ray;
  Hit hit = eye.hit;
  ++counts.camera;
  const Media* const media = frame.media.get();

  for (std::uint32_t bounce = 0;; ++bounce) {
    if (media) [[unlikely]] {
      const float way = hit.surface == kNone ? INFINITY : hit.t;
      MediumPoint collision;
      if (diffuse_light && bounce == 0) {
        const auto left = float(std::exp(-media->optical_depth(ray.origin, ray.direction, way)));
        throughput *= left;
        result.coverage = 1 - left;
      } else if (collides(*media, ray, way, random.hashed(), bounce, collision)) {
        if (bounce == 0) result.coverage = 1;
        if (inside.any()) throughput *= inside.transmittance_over(frame.materials, length(collision.position - ray.origin));
        if (!scatter_in_medium(scene, collision, random, bounce, path, throughput, last, ray, result, counts)) break;
        cone = {};
        ++counts.bounce;
        hit = {};
        scene.tracer.intersect(ray, hit);
        continue;
      }
    }
    if (hit.surface == kNone) {
      if (scene.lights.has_environment()) add_environment(scene, ray.direction, last, throughput, path.layer(), result);
      break;
    }
    result.coverage = 1;
    SurfacePoint point = scene.tracer.surface_point(hit);
    const Vec3 wo = -ray.direction;
    const bool front = dot(point.normal_geometric, wo) > 0;
    if (inside.any() || (!front && is_solid_glass(frame.materials[point.material])))
      throughput *= inside.transmittance_to(frame.materials, point.material, front, hit.t);
    cone.advance(hit.t);
    add_emission(scene, point, wo, last, throughput, path.layer(), cone.width, result);

    const SurfaceMaterial material(frame, point, cone.width);
    if (material.values().unlit) [[unlikely]] {
      if (path.sharp()) result[path.layer()] += throughput * material.values().base_color;
      break;
    }
    const ShadingPoint x(point, wo, material);
    const bool ends_here = diffuse_light && x.bsdf.has_diffuse();
    const bool controlled = ends_here && end && x.bsdf.is_matte();
    if (controlled && !inside.any()) {
      ends_matte = true;
      end->surface = point;
      end->normal = x.normal;
      end->normal_geometric = x.normal_geometric;
      end->reflected = throughput * x.bsdf.diffuse_albedo() * kInvPi;
      end->layer = path.after(true).layer();
      end->first = eye.first_light;
      end->count = eye.lights;
      end->bounce = bounce;
    } else {
      add_sampled_light(scene, x, throughput, path, inside, random, bounce, !ends_here, result, counts);
    }
    if (ends_here) {
      const bool seen_directly = path.layer() == Layer::emission;
      if (controlled && seen_directly) ++end->control.seen_matte;
      const DiffuseLight::Irradiance e = diffuse_light->at(point, x.normal_geometric, x.normal, seen_directly, nullptr);
      ++counts.lookups;
      // f_D's total for light from everywhere is rho (1 - A_S(wo)): see bsdf.h
      const Rgb reflected = throughput * x.bsdf.diffuse_reflectance(x.wo_local.z) * kInvPi;
      result[seen_directly ? Layer::caustic : Layer::specular] += reflected * e.caustic;
      result[seen_directly ? Layer::indirect : Layer::specular] += reflected * e.indirect;
    }

    if (ends_here && !x.bsdf.has_specular()) break;

    // Next direction: event D or S.
    const Bsdf::Sample next = x.bsdf.sample(x.wo_local, random.get1(bounce, Purpose::lobe), random.get2(bounce, Purpose::scatter));
    if (is_black(next.weight) || (ends_here && next.diffuse)) break;
    const Vec3 wi = x.frame.to_world(next.wi);
    if (next.transmitted ? !x.sees_beyond(wi) : !x.sees(wi)) break;
    throughput *= next.weight;
    path.scatter(next.diffuse);
    if (!next.diffuse && is_solid_glass(material)) inside.scatter(point.material, front, next.transmitted);

    if (bounce + 1 >= kRouletteFrom) {
      const float survival = std::min(kLargestSurvival, max_component(throughput));
      if (!(random.get1(bounce, Purpose::roulette) < survival)) break;
      throughput *= 1 / survival;
    }
    last.weighed = !next.delta;
    if (next.diffuse) cone = {};
    last.position = point.position;
    last.normal = next.transmitted ? -x.normal : x.normal;
    last.light_share = next.transmitted ? x.bsdf.light_share_beyond() : 1 - x.bsdf.light_share_beyond();
    last.pdf_solid_angle = next.diffuse ? x.bsdf.pdf_diffuse(next.wi, x.wo_local) : x.bsdf.pdf_specular(next.wi, x.wo_local);
    ray = spawn_ray(point, wi);
    ++counts.bounce;
    hit = {};
    scene.tracer.intersect(ray, hit);
  }
  return ends_matte;
}

}  // namespace

Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const DiffuseLight* diffuse_light, RayCounts& counts, RayCone cone) {
  EyeRay eye{camera_ray, {}, cone};
  scene.tracer.intersect(camera_ray, eye.hit);
  Layers layers;
  follow(scene, eye, random, diffuse_light, counts, nullptr, layers);
  return layers;
}

void trace_eye_paths(const RenderScene& scene, std::span<const EyeRay> eyes, const PixelRandom& random, std::uint32_t first,
                     const DiffuseLight* diffuse_light, RayCounts& counts, std::span<LightControl* const> controls, Layers* layers) {
  TEMPOLUX_CHECK(eyes.size() <= kPathsTogether && (controls.empty() || controls.size() == eyes.size()));
  thread_local std::array<MatteEnd, kPathsTogether> ends;   // not made anew for each pixel
  std::size_t count = 0, whose[kPathsTogether];
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    MatteEnd& end = ends[count];
    end.control = {};
    layers[i] = {};
    const bool matte = follow(scene, eyes[i], random.of_sample(first + std::uint32_t(i)), diffuse_light, counts,
                              controls.empty() ? nullptr : &end, layers[i]);
    if (matte) whose[count++] = i;
    else if (!controls.empty()) *controls[i] += end.control;
  }
  if (count == 0) return;
  sample_controlled_lights(scene, std::span(ends).first(count), random, counts);
  for (std::size_t k = 0; k < count; ++k) {
    layers[whose[k]][ends[k].layer] += ends[k].light;
    *controls[whose[k]] += ends[k].control;
  }
}

}  // namespace tempolux
