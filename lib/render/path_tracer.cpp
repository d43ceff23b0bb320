#include "lib/render/path_tracer.h"

#include <optional>
#include <utility>

#include "lib/core/sampling.h"
#include "lib/photon/photon_path.h"
#include "lib/render/eye_tracer.h"
#include "lib/scene/texture_lookup.h"
#include "lib/transport/roulette.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kRouletteFrom = 3;  ///< paths of fewer bounces always survive

}  // namespace

/// Russian roulette after the first bounces; `most`: the largest survival probability.
bool EyeTracer::survives(EyeState& state, float most) const {
  if (state.bounce + 1 < kRouletteFrom) return true;
  return tempolux::survives(state.throughput, most, state.random.get1(state.bounce, Purpose::roulette));
}

/// Follows a ray to its hit.
void EyeTracer::go_on(const Ray& ray, EyeState& state) const {
  state.ray = ray;
  count(1, counts_.bounce, state);
  state.hit = {};
  scene_.tracer.intersect(state.ray, state.hit);
  ++state.bounce;
}

/// Draws the next ray and follows it; u_lobe chooses the event, D or S. times: EyeVertex::times_diffuse or
/// times_specular. Returns false if the path ends.
bool EyeTracer::scatter(const EyeVertex& at, float u_lobe, float times, EyeState& state) const {
  const ShadingPoint& x = at.x;
  const Scattered event(x, u_lobe, state.random.get2(state.bounce, Purpose::scatter));
  const Bsdf::Sample& next = event.sample;
  if (is_black(next.weight) || (at.known.has(LightKind::direct) && next.diffuse)) return false;
  const Vec3 wi = event.travel;
  if (next.transmitted ? !x.sees_behind(wi) : !x.sees(wi)) return false;
  state.throughput *= next.weight * (1 / times);
  if (next.straight) {  // MIS keeps the pdf at the last vertex, because light samples from there pass panes as well
    state.path.pass_straight();
    if (!survives(state, kLargestPhotonSurvival)) return false;
    go_on(spawn_ray(x.surface, state.ray.direction), state);
    return true;
  }
  if (next.transmitted && at.hero) [[unlikely]]
    state.throughput *= at.hero->color, state.wavelength = at.hero->nm;
  state.path.scatter(next.diffuse);
  if (next.diffuse) {
    state.throughput *= at.remaining_share;
    begin_matte(at.known, state);
  } else {
    state.specular = true;
    state.refracted &= next.delta;
    if (!next.delta) state.widen(x.gloss_density(next.wi));
  }
  event.pass(x.surface, at.material, dot(x.surface.normal_geometric, state.ray.direction) < 0, state.inside);
  if (!survives(state, kLargestPhotonSurvival)) return false;

  LastScatter& last = state.last;
  last.weighed = !next.delta;
  if (next.diffuse) state.cone = {};
  last.position = x.surface.position;
  last.normal = next.transmitted ? -x.normal : x.normal;
  last.light_share = next.transmitted ? x.bsdf.light_share_behind() : 1 - x.bsdf.light_share_behind();
  last.from = sampled_lights();
  state.divided_leg = 0;
  if (at.divided_leg > 0 && !next.delta)
    state.divided_leg = at.divided_leg * (next.diffuse ? 1 : BrightPoints::width_of(x.gloss_density(next.wi)));
  state.divided = 0;
  if (next.diffuse) state.divided = at.spots_of_gloss;
  else if (!next.delta && at.spots_in_gloss) state.divided = BrightPoints::width_of(x.gloss_density(next.wi));
  last.pdf_solid_angle = times * (next.diffuse ? x.bsdf.pdf_diffuse(next.wi, x.eye) : x.pdf_specular(next.wi));
  go_on(spawn_ray(x.surface, wi), state);
  return true;
}

/// Scatters in a medium: samples a light, applies Russian roulette and draws a new ray. Returns false if the path ends.
bool EyeTracer::scatter_in_medium(const MediumPoint& point, EyeState& state) const {
  state.path.scatter_in_medium();
  begin_matte({}, state);
  state.cone = {};
  state.throughput *= point.albedo;
  if (is_black(state.throughput)) return false;
  const WayBits bits{state.random.hashed(), state.bounce, way_shadow_of_medium};
  std::uint64_t shadow_rays = 0;
  (*state.result)[state.path.layer()] +=
      state.throughput * scattered_lamp_light(scene_.tracer, scene_.lights, point,
                                              {state.random.get2(state.bounce, Purpose::light_point), true, bits},
                                              shadow_rays);
  count(shadow_rays, counts_.shadow, state);
  if (!survives(state, kLargestSurvivalInMedia)) return false;
  const Vec3 travel = sample_hg(point.g, point.travel, state.random.get2(state.bounce, Purpose::phase));
  state.divided = state.divided_leg = 0;
  state.last = {true, point.position, {}, pdf_hg(point.g, point.travel, travel), 1};
  go_on({point.position, travel, 0, INFINITY}, state);
  return true;
}

/// Passes the media between the last vertex and state.hit: by their exact transmittance if volume-compose adds the
/// light that they scatter, else by null collisions.
EyeTracer::Passed EyeTracer::pass_media(const Media& media, EyeState& state) const {
  const float way = state.hit.surface == kNone ? INFINITY : state.hit.t;
  if (known_ && state.bounce == 0) {
    const auto passed = float(std::exp(-media.optical_depth(state.ray.origin, state.ray.direction, way)));
    state.throughput *= passed;
    parts_.own.coverage = 1 - passed;
    return Passed::through;
  }
  MediumPoint collision;
  if (!collides(media, state.ray, way, state.random.hashed(), state.bounce, collision)) return Passed::through;
  if (state.bounce == 0) parts_.own.coverage = 1;
  if (state.known.has(LightKind::indirect)) return Passed::ended;
  if (state.inside.any())
    state.throughput *=
        state.inside.transmittance_over(scene_.frame().materials, length(collision.position - state.ray.origin));
  return scatter_in_medium(collision, state) ? Passed::scattered : Passed::ended;
}

/// Follows effort_.onward rays from the Lambert lobe of the first matte surface, which add to the part `onward`.
void EyeTracer::go_onward(const EyeVertex& at, float u_lobe, float times, const EyeState& state) const {
  if (at.known.has(LightKind::indirect) && at.known.has(LightKind::caustic) && !known_->lights_are_met) return;
  for (std::uint32_t i = 0; i < effort_.onward; ++i) {
    EyeState next = state;
    next.random = state.random.of_sample(effort_.onward_first + i);
    next.result = &parts_.onward;
    if (scatter(at, u_lobe, times, next)) follow(next);
  }
}

/// Adds light of a lamp or of the sky that the path meets.
void EyeTracer::add_met(Rgb light, const EyeState& state) const {
  (*state.result)[state.path.layer()] += light;
  if (state.path.only_specular()) state.result->mirrored += float(channel_mean(light));
}

/// Applies the absorption of glass between the last vertex and a surface, and adds the surface's emission.
void EyeTracer::arrive(const SurfacePoint& point, EyeState& state) const {
  const SceneFrame& frame = scene_.frame();
  const Vec3 wo = -state.ray.direction;
  const bool front = dot(point.normal_geometric, wo) > 0,
             solid = bounds_solid(frame.materials[point.material], point.plate);
  if (state.inside.any() || (!front && solid))
    state.throughput *= state.inside.transmittance_to(frame.materials, point.material, front, state.hit.t);
  state.cone.advance(state.hit.t);
  state.distance += state.spread * state.hit.t;
  const bool hidden = scene_.without_hidden_light && !state.last.weighed &&
                      (state.path.layer() == Layer::caustic || state.path.layer() == Layer::indirect);
  if (!hidden && state.light_counts() && !was_sampled(state.divided_leg, point.position, state.last.position))
    add_met(state.throughput * weighed_emission(scene_.lights, point, wo, state.last, state.cone.width), state);
}

/// Continues the path from a surface. If the path forks, `state` follows one lobe, and a copy follows the other to its
/// end. Returns false if `state` ends.
bool EyeTracer::leave(const EyeVertex& at, EyeState& state) const {
  const ShadingPoint& x = at.x;
  const bool first_matte = state.path.sharp() && x.bsdf.has_diffuse();
  float u_lobe = state.random.get1(state.bounce, Purpose::lobe), times = 1;
  if (at.forks) {
    const float diffuse = 1 / at.times_diffuse;
    state.forked = true;
    EyeState branch = state;
    if (scatter(at, std::min(kOneMinusEpsilon, diffuse + (1 - diffuse) * u_lobe), at.times_specular, branch))
      follow(branch);
    u_lobe *= diffuse;
    times = at.times_diffuse;
  }
  if (first_matte && x.bsdf.draws_diffuse(x.eye, u_lobe)) {
    go_onward(at, u_lobe, times, state);
    return false;
  }
  return scatter(at, u_lobe, times, state);
}

/// The side of a surface from which the path goes on, with its lobes. If the surface transmits diffusely, one of the
/// two sides is drawn; far_side is true for the side from which the path did not come.
ShadingPoint EyeTracer::shade(const SurfacePoint& point, const MaterialValues& material, EyeState& state,
                              bool& far_side) const {
  const Vec3 wo = -state.ray.direction;
  if (!transmits_diffusely(material)) [[likely]]
    return {point, wo, material};
  const ShadingPoint own(point, wo, material);
  const SideChoice side = choose_side(own.bsdf, own.wo_local, material, state.random.get1(state.bounce, Purpose::side));
  state.throughput *= 1 / side.chance;
  far_side = side.far_side;
  if (!far_side) return own;
  if (bounds_solid(material, point.plate))
    state.inside.scatter(point.material, dot(point.normal_geometric, wo) > 0, true);
  return ShadingPoint::on_far_side(point, wo, material);
}

/// Adds the light at state.hit and continues the path from there. Returns false if the path ends.
bool EyeTracer::step(EyeState& state) const {
  const SceneFrame& frame = scene_.frame();
  if (const Media* const media = frame.media.get()) [[unlikely]] {
    const Passed media_event = pass_media(*media, state);
    if (media_event != Passed::through) return media_event == Passed::scattered;
  }
  if (state.hit.surface == kNone) {
    if (scene_.lights.has_environment() && state.light_counts())
      add_met(state.throughput * weighed_environment(scene_.lights, state.ray.direction, state.last), state);
    return false;
  }
  parts_.own.coverage = 1;
  SurfacePoint point = scene_.tracer.surface_point(state.hit);
  const bool refracting_plate = state.refracted && point.plate > 0;
  if (refracting_plate) point.plate = 0;
  arrive(point, state);
  // If true, only light by events S and light behind panes has not been added yet.
  const bool only_specular = state.known.has(LightKind::indirect);
  if (only_specular && state.known.has(LightKind::caustic) && !scene_.tracer.may_pass(state.hit)) return false;

  const Vec3 smooth = point.normal;
  const std::optional<HeroWavelength> hero =
      draw_wavelength(frame.materials[point.material], point.plate, state.wavelength, state.random);
  const SurfaceMaterial material(frame, point, state.cone.width, hero ? hero->nm : state.wavelength);
  if (material.values().unlit) [[unlikely]] {
    if (state.path.sharp()) add_met(state.throughput * material.values().base_color, state);
    return false;
  }
  bool far_side = false;
  const ShadingPoint x = shade(point, material, state, far_side);
  EyeVertex at{x, material, hero ? &*hero : nullptr};
  at.far_side = far_side;
  // A path that entered a plate has met a matte or rough surface inside, such as a frame. Light samples reach this
  // surface straight and without absorption, so the path forgets the plate's glass.
  if (state.plate != kNone && (x.bsdf.has_diffuse() || !x.bsdf.specular_is_delta())) [[unlikely]]
    state.inside.forget(std::exchange(state.plate, kNone));
  if (refracting_plate) state.plate = point.material;
  if (only_specular) at.known = {LightKind::direct, LightKind::caustic, LightKind::indirect, LightKind::lamps};
  if (known_ && !only_specular && x.bsdf.has_diffuse()) add_known_light(at, smooth, state);
  if (known_ && known_->forks() && !state.forked && state.path.sharp() && x.bsdf.forks())
    at.fork(std::clamp(x.bsdf.fork_probability(x.eye), 0x1p-20f, 1 - 0x1p-20f));
  choose_spots(at, state);
  if (state.divided > 0 && x.bsdf.has_diffuse() && !far_side)
    at.divided_leg = state.divided * length(point.position - state.last.position);
  add_light(at, state);
  return !(at.known.has(LightKind::direct) && !x.bsdf.has_specular()) && leave(at, state);
}

void EyeTracer::follow(EyeState state) const {
  while (step(state)) {}
}

PathParts trace_eye_parts(const RenderScene& scene, const EyeRay& eye, const PixelRandom& random,
                          const KnownLight* known, RayCounts& counts, const PathEffort& effort) {
  PathParts parts;
  ++counts.camera;
  EyeTracer(scene, known, effort, counts, parts)
      .follow({random, &parts.own, eye.ray, eye.first, eye.cone, Rgb(1.0f), {}, scene.camera_inside, {}});
  return parts;
}

Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const KnownLight* known, RayCounts& counts, RayCone cone) {
  Hit first;
  scene.tracer.intersect(camera_ray, first);
  return trace_eye_parts(scene, {camera_ray, first, cone}, random, known, counts, effort_of(random.sample())).sum();
}

}  // namespace tempolux
