#include "lib/render/path_tracer.h"

#include "lib/core/sampling.h"
#include "lib/material/inside.h"
#include "lib/photon/photon_path.h"
#include "lib/render/known_light.h"
#include "lib/render/shading.h"
#include "lib/scene/texture_lookup.h"
#include "lib/transport/emission.h"
#include "lib/transport/media.h"
#include "lib/transport/roulette.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kRouletteFrom = 3;                  ///< number of bounces that always survive
constexpr float kLargestSurvival = kLargestPhotonSurvival;  ///< below 1: paths in a lossless box end, as photons do

/// The state of a path on its way: the ray from the last vertex, and the light that must not be added again. An event D
/// is a Lambert lobe or a collision in a medium.
struct PathState {
  PixelRandom random;           ///< random numbers of the path, by bounce
  Layers* result;               ///< the part of the sample that receives the light found from here on
  Ray ray;                      ///< leaves the last vertex
  Hit hit;                      ///< what `ray` meets
  RayCone cone;                 ///< width of the path's footprint, for look-ups in textures
  Rgb throughput{1.0f};         ///< product of the weights of all events
  EyePath path;                 ///< the events so far: they decide the layer of light that is found
  Inside inside;                ///< the glass in which `ray` runs
  LastScatter last;             ///< the last vertex and its pdf, for MIS
  std::uint32_t bounce = 0;     ///< number of events
  bool forked = false;          ///< both lobes of a surface have been followed: the path forks once
  bool matte = false;           ///< there was an event D; the fields below concern the last one
  bool caustic_known = false;   ///< the light that arrives at its place by events S was added
  bool indirect_known = false;  ///< the light that arrives at its place by events D was added
  bool specular = false;        ///< events S followed
  /// At the last event D the bright points were sampled explicitly, so the next Lambert lobe contributes only the
  /// remaining light.
  bool bright_sampled = false;
  /// m: a ray from a Lambert lobe would have spread as far after this distance. Equal to the path's length since the
  /// last event D; 0 if the path has met only smooth mirrors and glass.
  float distance = 0;
  float spread = 0;  ///< growth of `distance` per metre of path

  /// Widens the spread by a glossy event of this pdf [1/sr]. A Lambert lobe has 1/pi in its middle, and its rays spread
  /// by one metre per metre.
  void widen(float density) { spread = std::max(spread, std::min(1.0f, 1 / std::sqrt(kPi * density))); }
  /// True if light that the path meets now was not added yet.
  bool light_counts() const { return !(matte && specular && caustic_known); }
};

/// A surface that a path has reached. Records, points and photons may hold light that arrives there; light that was
/// added from them must not be added again.
struct Vertex {
  const ShadingPoint& x;
  const SurfaceMaterial& material;
  bool indirect_known = false;  ///< light that arrives by events D was added
  bool direct_known = false;    ///< light that arrives from lights was added: none is sampled for the Lambert lobe
  bool caustic_known = false;   ///< light that arrives by events S was added
  bool bright_sampled = false;  ///< bright points were sampled explicitly
  bool lamps_apart = false;     ///< records were read that leave out the light of KnownLight::lamp_spots
  float remaining_share = 1;  ///< share of the Lambert lobe's light that was not sampled explicitly at the last vertex
  bool forks = false;         ///< both lobes are followed
  float times_diffuse = 1, times_specular = 1;  ///< probability of a lobe over the Bsdf's, if the path forks

  /// probability: Bsdf::fork_probability, in (0, 1). At glass times_diffuse is the reflection's factor and
  /// times_specular that of the transmission.
  void fork(float probability) {
    forks = true;
    times_diffuse = 1 / probability;
    times_specular = 1 / (1 - probability);
  }
};

class EyeTracer {
 public:
  EyeTracer(const RenderScene& scene, const KnownLight* known, const PathEffort& effort, RayCounts& counts,
            PathParts& parts)
      : scene_(scene), known_(known), effort_(effort), counts_(counts), parts_(parts) {}
  void follow(PathState state) const;

 private:
  enum class Passed { through, scattered, ended };
  Passed pass_media(const Media& media, PathState& state) const;
  bool scatter_in_medium(const MediumPoint& point, PathState& state) const;
  bool scatter(const Vertex& at, float u_lobe, float times, PathState& state) const;
  bool survives(PathState& state, float most) const;
  /// Begins the part of a path that follows an event D.
  static void begin_matte(bool caustic_known, bool indirect_known, bool bright_sampled, PathState& state) {
    state.matte = true, state.specular = false;
    state.caustic_known = caustic_known, state.indirect_known = indirect_known, state.bright_sampled = bright_sampled;
    state.distance = 0, state.spread = 1;
  }
  void go_on(const Ray& ray, PathState& state) const;
  bool samples_diffuse(const Vertex& at) const { return !at.direct_known && at.x.bsdf.has_diffuse(); }
  bool samples_specular(const Vertex& at, const PathState& state) const {
    return !(state.matte && state.caustic_known) && at.x.bsdf.has_specular() && !at.x.bsdf.specular_is_delta();
  }
  Lights::From sampled_lights() const { return scene_.suns_apart ? Lights::From::not_suns : Lights::From::all; }
  void sample_light(const Vertex& at, const PathState& state, const PixelRandom& random, bool of_sun,
                    Layers& result) const;
  void sample_lamp_spots(const Vertex& at, const PathState& state, const PixelRandom& random, Layers& result) const;
  void add_light(const Vertex& at, const PathState& state) const;
  void arrive(const SurfacePoint& point, PathState& state) const;
  void add_known_light(Vertex& at, Vec3 smooth, const PathState& state) const;
  bool leave(const Vertex& at, PathState& state) const;
  bool step(PathState& state) const;
  void go_onward(const Vertex& at, float u_lobe, float times, const PathState& state) const;
  void count(std::uint64_t rays, std::uint64_t& as, const PathState& state) const {
    as += rays;
    if (state.result == &parts_.onward)
      // Nearest hit, surface and material cost twice as much as a shadow ray.
      counts_.onward += &as == &counts_.bounce ? 2 * rays : rays;
  }

  const RenderScene& scene_;
  const KnownLight* known_;
  const PathEffort& effort_;
  RayCounts& counts_;
  PathParts& parts_;
};

/// Russian roulette; `most`: the largest survival probability.
bool EyeTracer::survives(PathState& state, float most) const {
  if (state.bounce + 1 < kRouletteFrom) return true;
  return tempolux::survives(state.throughput, most, state.random.get1(state.bounce, Purpose::roulette));
}

void EyeTracer::go_on(const Ray& ray, PathState& state) const {
  state.ray = ray;
  count(1, counts_.bounce, state);
  state.hit = {};
  scene_.tracer.intersect(state.ray, state.hit);
  ++state.bounce;
}

/// Draws the next ray: an event D or S by u_lobe. times: the lobe's probability over the Bsdf's. Returns false if the
/// path ends.
bool EyeTracer::scatter(const Vertex& at, float u_lobe, float times, PathState& state) const {
  const ShadingPoint& x = at.x;
  const Bsdf::Sample next = x.bsdf.sample(x.eye, u_lobe, state.random.get2(state.bounce, Purpose::scatter));
  if (is_black(next.weight) || (at.direct_known && next.diffuse)) return false;
  const Vec3 wi = x.frame.to_world(next.wi);
  if (next.transmitted ? !x.sees_behind(wi) : !x.sees(wi)) return false;
  state.throughput *= next.weight * (1 / times);
  if (next.straight) {  // MIS keeps the densities of the last vertex, whose light samples pass panes as well
    state.path.pass_straight();
    if (!survives(state, kLargestSurvival)) return false;
    go_on(spawn_ray(x.surface, state.ray.direction), state);
    return true;
  }
  state.path.scatter(next.diffuse);
  if (next.diffuse) {
    state.throughput *= at.remaining_share;
    begin_matte(at.caustic_known, at.indirect_known, at.bright_sampled, state);
  } else {
    state.specular = true;
    state.widen(x.bsdf.gloss_density(next.wi, x.eye));
  }
  const bool front = dot(x.surface.normal_geometric, state.ray.direction) < 0;
  if (!next.diffuse && is_solid_glass(at.material)) state.inside.scatter(x.surface.material, front, next.transmitted);
  if (!survives(state, kLargestSurvival)) return false;

  LastScatter& last = state.last;
  last.weighed = !next.delta;
  if (next.diffuse) state.cone = {};
  last.position = x.surface.position;
  last.normal = next.transmitted ? -x.normal : x.normal;
  last.light_share = next.transmitted ? x.bsdf.light_share_behind() : 1 - x.bsdf.light_share_behind();
  last.from = sampled_lights();
  last.pdf_solid_angle =
      times * (next.diffuse ? x.bsdf.pdf_diffuse(next.wi, x.eye) : x.bsdf.pdf_specular(next.wi, x.eye));
  go_on(spawn_ray(x.surface, wi), state);
  return true;
}

/// Scatters in a medium: samples a light, applies Russian roulette and draws a new ray. Returns false if the path ends.
bool EyeTracer::scatter_in_medium(const MediumPoint& point, PathState& state) const {
  state.path.scatter_in_medium();
  begin_matte(false, false, false, state);
  state.cone = {};
  state.throughput *= point.albedo;
  if (is_black(state.throughput)) return false;
  const WayBits bits{state.random.hashed(), state.bounce, way_shadow_of_medium};
  std::uint64_t shadow_rays = 0;
  (*state.result)[state.path.layer()] +=
      state.throughput * scattered_lamp_light(scene_.tracer, scene_.lights, point,
                                              state.random.get2(state.bounce, Purpose::light_point), true, bits,
                                              shadow_rays);
  count(shadow_rays, counts_.shadow, state);
  if (!survives(state, kLargestSurvivalInMedia)) return false;
  const Vec3 travel = sample_hg(point.g, point.travel, state.random.get2(state.bounce, Purpose::phase));
  state.last = {true, point.position, {}, pdf_hg(point.g, point.travel, travel), 1};
  go_on({point.position, travel, 0, INFINITY}, state);
  return true;
}

/// Passes the media between the last vertex and state.hit.
EyeTracer::Passed EyeTracer::pass_media(const Media& media, PathState& state) const {
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
  if (state.indirect_known) return Passed::ended;
  if (state.inside.any())
    state.throughput *=
        state.inside.transmittance_over(scene_.frame().materials, length(collision.position - state.ray.origin));
  return scatter_in_medium(collision, state) ? Passed::scattered : Passed::ended;
}

/// Takes one sample of the lights or of the sun and adds it to the layer of the lobe that scatters it, weighted by MIS.
/// [Veach 1997 (9.14)]
void EyeTracer::sample_light(const Vertex& at, const PathState& state, const PixelRandom& random, bool of_sun,
                             Layers& result) const {
  const ShadingPoint& x = at.x;
  const bool has_diffuse = samples_diffuse(at), has_specular = samples_specular(at, state);
  // Rough glass also transmits light from behind. One side is drawn for this sample.
  const float share_behind = x.bsdf.light_share_behind();
  bool behind = false;
  float share = 1;
  if (share_behind > 0) [[unlikely]] {
    behind = random.get1(state.bounce, Purpose::light_choice) < share_behind;
    share = behind ? share_behind : 1 - share_behind;
  }
  LightSample light;
  const Vec3 normal = behind ? -x.normal : x.normal;
  const bool found =
      of_sun ? scene_.lights.sample_sun(x.surface.position, normal, random.get1(state.bounce, Purpose::sun), light)
             : scene_.lights.sample(x.surface.position, normal, random.get2(state.bounce, Purpose::light_point), light,
                                    sampled_lights());
  if (!found || (behind ? !x.sees_behind(light.wi) : !x.sees(light.wi))) return;
  const Bsdf::Direction from = x.bsdf.along(x.frame.to_local(light.wi));
  const Vec3 wi = from.w;
  Rgb diffuse = has_diffuse ? x.bsdf.eval_diffuse(from, x.eye) * at.remaining_share : Rgb(0.0f);
  Rgb glossy = has_specular ? x.bsdf.eval_specular(from, x.eye) : Rgb(0.0f);
  if (!light.delta) {
    const float pdf = light.pdf_solid_angle * share;
    if (has_diffuse) diffuse *= mis_power(pdf, at.times_diffuse * x.bsdf.pdf_diffuse(wi, x.eye));
    if (has_specular) glossy *= mis_power(pdf, at.times_specular * x.bsdf.pdf_specular(wi, x.eye));
  }
  if (is_black(diffuse) && is_black(glossy)) return;
  count(1, counts_.shadow, state);
  const Ray shadow = spawn_shadow_ray(x.surface, light.position, light.position_offset);
  const Rgb passed = transmittance(scene_.tracer, shadow, {random.hashed(), state.bounce, way_shadow});
  if (is_black(passed)) return;
  Rgb arriving = state.throughput * light.facing_irradiance * (std::abs(wi.z) / share) * passed;
  if (state.inside.any())
    arriving *= state.inside.transmittance_over(scene_.frame().materials, length(light.position - x.surface.position));
  result[state.path.after(true).layer()] += arriving * diffuse;
  result[state.path.after(false).layer()] += arriving * glossy;
}

/// Takes one sample of the light that the records at a surface leave out.
void EyeTracer::sample_lamp_spots(const Vertex& at, const PathState& state, const PixelRandom& random,
                                  Layers& result) const {
  const ShadingPoint& x = at.x;
  GatherCounts rays;
  BrightPoints::Receiver place{x.surface, x.normal, x.bsdf.has_specular() ? &x.bsdf : nullptr};
  place.choice = random.get1(state.bounce, Purpose::light_choice);
  const PathRandom within(random.hashed().bits(state.bounce, Purpose::gather), state.bounce);
  const Rgb irradiance(known_->lamp_spots->arriving(place, 1, within, rays).irradiance);
  count(rays.shadow_rays, counts_.shadow, state);
  result[state.path.after(true).after(true).layer()] +=
      state.throughput * x.bsdf.diffuse_reflectance(x.wo_local.z) * (kInvPi * at.remaining_share) * irradiance;
}

/// Samples light at a surface. At the first matte surface effort_.lit samples are added to the part `lit`. Samples of
/// the sun hardly differ from each other, so one per camera ray is enough; it belongs to the path's own part.
void EyeTracer::add_light(const Vertex& at, const PathState& state) const {
  const bool first_matte = state.path.sharp() && at.x.bsdf.has_diffuse();
  const auto each = [&](const auto& sample) {
    if (!first_matte) sample(state.random, *state.result);
    else
      for (std::uint32_t i = 0; i < effort_.lit; ++i) sample(state.random.of_sample(effort_.lit_first + i), parts_.lit);
  };
  if (at.lamps_apart)
    each([&](const PixelRandom& random, Layers& result) { sample_lamp_spots(at, state, random, result); });
  if (!samples_diffuse(at) && !samples_specular(at, state)) return;
  if (scene_.suns_apart) sample_light(at, state, state.random, true, *state.result);
  each([&](const PixelRandom& random, Layers& result) { sample_light(at, state, random, false, result); });
}

/// Follows effort_.onward rays from the Lambert lobe of the first matte surface: the part `onward`.
void EyeTracer::go_onward(const Vertex& at, float u_lobe, float times, const PathState& state) const {
  if (at.indirect_known && at.caustic_known && !known_->lights_are_met) return;
  for (std::uint32_t i = 0; i < effort_.onward; ++i) {
    PathState next = state;
    next.random = state.random.of_sample(effort_.onward_first + i);
    next.result = &parts_.onward;
    if (scatter(at, u_lobe, times, next)) follow(next);
  }
}

/// Arrival at a surface: applies the absorption of glass on the way and adds the surface's emission.
void EyeTracer::arrive(const SurfacePoint& point, PathState& state) const {
  const SceneFrame& frame = scene_.frame();
  const Vec3 wo = -state.ray.direction;
  const bool front = dot(point.normal_geometric, wo) > 0;
  if (state.inside.any() || (!front && is_solid_glass(frame.materials[point.material])))
    state.throughput *= state.inside.transmittance_to(frame.materials, point.material, front, state.hit.t);
  state.cone.advance(state.hit.t);
  state.distance += state.spread * state.hit.t;
  if (state.light_counts())
    (*state.result)[state.path.layer()] +=
        state.throughput * weighed_emission(scene_.lights, point, wo, state.last, state.cone.width);
}

/// Follows the rays that leave a surface: one, or one for each lobe where the path forks. Returns false if `state`
/// ends.
bool EyeTracer::leave(const Vertex& at, PathState& state) const {
  const ShadingPoint& x = at.x;
  const bool first_matte = state.path.sharp() && x.bsdf.has_diffuse();
  float u_lobe = state.random.get1(state.bounce, Purpose::lobe), times = 1;
  if (at.forks) {
    const float diffuse = 1 / at.times_diffuse;
    state.forked = true;
    PathState branch = state;
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

/// Adds the light that records, points and photons hold for x. smooth: the shading normal without a normal map.
void EyeTracer::add_known_light(Vertex& at, Vec3 smooth, const PathState& state) const {
  const KnownLight& known = *known_;
  const ShadingPoint& x = at.x;
  const EyePath& path = state.path;
  Layers& result = *state.result;
  const float u = state.random.get1(state.bounce, Purpose::gather);
  if (state.bright_sampled && !state.specular)
    at.remaining_share = known.remaining_share(x.surface, x.normal_geometric, state.distance, u);
  // The Lambert lobe's total for uniform light is rho (1 - A_S(wo)), see bsdf.h.
  const Rgb reflected = state.throughput * x.bsdf.diffuse_reflectance(x.wo_local.z) * (kInvPi * at.remaining_share);
  // The layer indirect, or the layer of the surface that the path has seen before.
  const Layer layer = path.after(true).after(true).layer();
  // With bright points, a point's irradiance represents only the remaining light. A glossy ray has not sampled bright
  // points, so the path continues.
  if (state.matte || (state.spread > 0 && !known.bright)) {
    if (const std::optional<KnownLight::PointLight> stored =
            known.point_light(x.surface, x.normal_geometric, state.distance, u)) {
      ++counts_.points_read;
      result[layer] += reflected * stored->irradiance;
      at.indirect_known = at.caustic_known = true;
      at.direct_known = stored->has_direct;
      return;
    }
  }
  const auto sample_bright = [&](int samples) {
    if (!known.bright) return;
    GatherCounts rays;
    const PathRandom random(state.random.hashed().bits(state.bounce, Purpose::gather), state.bounce);
    const Bsdf* const coat = x.bsdf.has_specular() ? &x.bsdf : nullptr;
    result[layer] +=
        reflected * Rgb(known.bright->arriving({x.surface, x.normal, coat}, samples, random, rays).irradiance);
    counts_.shadow += rays.shadow_rays;
    at.bright_sampled = true;
  };
  if (known.has_caustic()) {
    at.caustic_known = true;
    const Layer caustic = path.after(true).after(false).layer();
    const FootprintLight light =
        known.caustic(x.surface.position, {x.normal_geometric, x.facing(smooth), x.normal, &x.bsdf});
    result[caustic] += reflected * light.irradiance;
    if (caustic == Layer::caustic) parts_.stored_noise.caustic += reflected * light.noise;
  }
  if (state.matte) {
    sample_bright(1);
    return;
  }
  Rgb noise(0.0f);
  if (const std::optional<Rgb> indirect = known.indirect(x.surface, x.normal_geometric, x.normal, &noise)) {
    ++counts_.lookups;
    at.indirect_known = true;
    result[layer] += reflected * *indirect;
    at.lamps_apart = known.lamp_spots != nullptr;
    if (layer == Layer::indirect) parts_.stored_noise.indirect += reflected * noise;
  } else {
    ++counts_.gathered;
    sample_bright(known.bright_samples);
  }
}

/// Moves the path from one vertex to the next. Returns false if the path ends.
bool EyeTracer::step(PathState& state) const {
  const SceneFrame& frame = scene_.frame();
  if (const Media* const media = frame.media.get()) [[unlikely]] {
    const Passed media_event = pass_media(*media, state);
    if (media_event != Passed::through) return media_event == Passed::scattered;
  }
  Layers& result = *state.result;
  if (state.hit.surface == kNone) {
    if (scene_.lights.has_environment() && state.light_counts())
      result[state.path.layer()] +=
          state.throughput * weighed_environment(scene_.lights, state.ray.direction, state.last);
    return false;
  }
  parts_.own.coverage = 1;
  SurfacePoint point = scene_.tracer.surface_point(state.hit);
  arrive(point, state);
  // True if only light by events S may still be added, or lights behind panes.
  const bool only_specular = state.indirect_known;
  if (only_specular && state.caustic_known && !may_be_pane(frame.materials[point.material])) return false;

  const Vec3 smooth = point.normal;
  const SurfaceMaterial material(frame, point, state.cone.width);
  if (material.values().unlit) [[unlikely]] {
    if (state.path.sharp()) result[state.path.layer()] += state.throughput * material.values().base_color;
    return false;
  }
  const ShadingPoint x(point, -state.ray.direction, material);
  Vertex at{x, material, only_specular, only_specular, only_specular};
  if (known_ && !only_specular && x.bsdf.has_diffuse()) add_known_light(at, smooth, state);
  if (known_ && known_->forks() && !state.forked && state.path.sharp() && x.bsdf.forks())
    at.fork(std::clamp(x.bsdf.fork_probability(x.eye), 0x1p-20f, 1 - 0x1p-20f));
  add_light(at, state);
  return !(at.direct_known && !x.bsdf.has_specular()) && leave(at, state);
}

void EyeTracer::follow(PathState state) const {
  while (step(state)) {}
}

}  // namespace

PathParts trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const Hit& first, const PixelRandom& random,
                         const KnownLight* known, RayCounts& counts, RayCone cone, const PathEffort& effort) {
  PathParts parts;
  ++counts.camera;
  EyeTracer(scene, known, effort, counts, parts)
      .follow({random, &parts.own, camera_ray, first, cone, Rgb(1.0f), {}, {}, {}});
  return parts;
}

Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const KnownLight* known, RayCounts& counts, RayCone cone) {
  Hit first;
  scene.tracer.intersect(camera_ray, first);
  return trace_eye_path(scene, camera_ray, first, random, known, counts, cone, effort_of(random.sample())).sum();
}

}  // namespace tempolux
