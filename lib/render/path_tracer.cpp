#include "lib/render/path_tracer.h"

#include <optional>
#include <utility>

#include "lib/core/sampling.h"
#include "lib/material/inside.h"
#include "lib/photon/photon_path.h"
#include "lib/render/known_light.h"
#include "lib/render/stored_places.h"
#include "lib/transport/light_kinds.h"
#include "lib/scene/texture_lookup.h"
#include "lib/transport/emission.h"
#include "lib/transport/media.h"
#include "lib/transport/roulette.h"
#include "lib/transport/specular_chain.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kRouletteFrom = 3;  ///< paths of fewer bounces always survive

/// A path between two vertices: its ray, its events so far, and which light was added already. Here an event D is
/// scattering by a Lambert lobe or in a medium.
struct PathState {
  PixelRandom random;        ///< random numbers of the path, by bounce
  Layers* result;            ///< receives the light that the path finds from here on: one part of the sample
  Ray ray;                   ///< leaves the last vertex
  Hit hit;                   ///< what `ray` meets
  RayCone cone;              ///< width of the path's footprint, for look-ups in textures
  Rgb throughput{1.0f};      ///< product of the weights of all events
  EyePath path;              ///< the events so far: they decide the layer of light that is found
  Inside inside;             ///< the glass in which `ray` runs
  LastScatter last;          ///< the last vertex and its pdf, for MIS
  std::uint32_t bounce = 0;  ///< number of events
  float wavelength = 0;      ///< HeroWavelength::nm; 0: the path is white
  bool forked = false;       ///< true if the path has forked, so that both lobes of a surface were followed
  bool matte = false;        ///< true after an event D; the fields below concern the last event D
  /// Light at the place of that event that was added already. With `bright`, light of bright points was sampled there,
  /// and the next Lambert lobe that the path meets adds only the remaining share.
  LightKinds known{};
  bool specular = false;  ///< true if events S followed
  /// True until the path has left a surface or a medium where lights are sampled. Until then plates of glass refract
  /// the path; afterwards it passes them straight, as light samples do.
  bool refracted = true;
  std::uint32_t plate = kNone;  ///< material of the plate that the path has entered while it was refracted
  /// Distance [m] after which a ray from a Lambert lobe has spread as far as this path. The path's length since the
  /// last event D, if no glossy event widened the path; 0 if it has met only smooth mirrors and glass.
  float distance = 0;
  float spread = 0;  ///< growth of `distance` per metre of path
  /// Width (BrightPoints::width_of) of the lobe that sent `ray`, if light of spots was sampled for this lobe; else 0. A
  /// spot is the bright place on a surface close to a lamp (BrightPoints::lamp_spot).
  float divided = 0;
  /// Length [m] of the path's leg before the last vertex, times the widths of the lobes at both ends, if light of spots
  /// was sampled for it; else 0.
  float divided_leg = 0;

  /// Widens the spread by a glossy event of this pdf [1/sr]. The spread of a Lambert lobe is 1; its pdf is 1 / pi in
  /// the middle.
  void widen(float pdf_solid_angle) { spread = std::max(spread, std::min(1.0f, 1 / std::sqrt(kPi * pdf_solid_angle))); }
  /// True if light that the path meets now has not been added yet.
  bool light_counts() const { return !(matte && specular && known.has(LightKind::caustic)); }
};

/// A surface that a path has reached, and the kinds of light there that were added from records, points and photons.
struct Vertex {
  const ShadingPoint& x;
  const SurfaceMaterial& material;
  /// The wavelength that the path takes if the surface refracts it; null: the surface has no dispersion, or the path
  /// has its wavelength already.
  const HeroWavelength* drawn = nullptr;
  LightKinds known{};         ///< light that was added
  float remaining_share = 1;  ///< share of the Lambert lobe's light that was not sampled explicitly at the last vertex
  bool forks = false;         ///< both lobes are followed
  /// Length [m] of the leg to this vertex times PathState::divided. If it is above 0, the light of lamps close to this
  /// vertex is divided (BrightPoints).
  float divided_leg = 0;
  /// For which lobes light of spots is sampled here. spots: light that the Lambert lobe of a spot sends to the Lambert
  /// lobe here. spots_of_gloss: light that the lobes S of a spot send to the Lambert lobe here. spots_in_gloss: light
  /// that the lobes S here receive from spots.
  bool spots = false, spots_of_gloss = false, spots_in_gloss = false;
  /// Probability with which the path follows a lobe, over the probability with which Bsdf::sample() draws the lobe.
  float times_diffuse = 1, times_specular = 1;

  /// probability: Bsdf::fork_probability, in (0, 1). At glass, times_diffuse is the factor of the reflection, and
  /// times_specular is the factor of the transmission.
  void fork(float probability) {
    forks = true;
    times_diffuse = 1 / probability;
    times_specular = 1 / (1 - probability);
  }
};

/// The place at which stored light is looked up for a surface, with its normals on the lit side. At a moment of a
/// shutter it is the same place of the surface at the frame's time; else it is the surface itself.
class StoredAt {
 public:
  StoredAt(const RenderScene& scene, const ShadingPoint& x)
      : surface(&x.surface), geometric(x.normal_geometric), shading(x.normal) {
    if (!scene.stored) [[likely]]
      return;
    moved_ = scene.stored->of(x.surface, x.normal_geometric, x.normal);
    surface = &moved_->surface, geometric = moved_->geometric, shading = moved_->shading;
  }
  StoredAt(const StoredAt&) = delete;
  const SurfacePoint* surface;
  Vec3 geometric, shading;
  /// The surface's shading normal without a normal map, on the lit side.
  Vec3 smooth(Vec3 here, const ShadingPoint& x) const {
    if (!moved_) [[likely]]
      return x.facing(here);
    return dot(moved_->surface.normal, geometric) < 0 ? -moved_->surface.normal : moved_->surface.normal;
  }

 private:
  std::optional<StoredPlaces::Place> moved_;
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
  /// Sets the state after an event D.
  static void begin_matte(LightKinds known, PathState& state) {
    state.matte = true, state.specular = false, state.refracted = false, state.known = known;
    state.distance = 0, state.spread = 1;
  }
  void go_on(const Ray& ray, PathState& state) const;
  bool samples_diffuse(const Vertex& at) const { return !at.known.has(LightKind::direct) && at.x.bsdf.has_diffuse(); }
  bool samples_specular(const Vertex& at, const PathState& state) const {
    return !(state.matte && state.known.has(LightKind::caustic)) && at.x.bsdf.has_specular() &&
           !at.x.bsdf.specular_is_delta();
  }
  Lights::From sampled_lights() const { return scene_.suns_apart ? Lights::From::not_suns : Lights::From::all; }
  void sample_light(const Vertex& at, const PathState& state, const PixelRandom& random, bool of_sun,
                    Layers& result) const;
  void sample_spots(const BrightPoints& spots, const Vertex& at, const PathState& state, const PixelRandom& random,
                    Layers& result) const;
  void add_light(const Vertex& at, const PathState& state) const;
  void add_met(Rgb light, const PathState& state) const;
  void arrive(const SurfacePoint& point, PathState& state) const;
  void add_known_light(Vertex& at, Vec3 smooth, const PathState& state) const;
  bool leave(const Vertex& at, PathState& state) const;
  bool step(PathState& state) const;
  void choose_spots(Vertex& at, const PathState& state) const;
  bool was_sampled(float divided_leg, Vec3 lamp, Vec3 position) const {
    return divided_leg > 0 && known_->samples_spot(divided_leg, length(lamp - position));
  }
  void go_onward(const Vertex& at, float u_lobe, float times, const PathState& state) const;
  /// Adds `rays` to the counter `as`. If the path belongs to the part onward, also adds the rays' cost to
  /// counts_.onward.
  void count(std::uint64_t rays, std::uint64_t& as, const PathState& state) const {
    as += rays;
    if (state.result != &parts_.onward) return;
    const bool bounce = &as == &counts_.bounce;
    counts_.onward += bounce ? 2 * rays : rays;
    if (bounce) counts_.onward_bounce += rays;
  }

  const RenderScene& scene_;
  const KnownLight* known_;
  const PathEffort& effort_;
  RayCounts& counts_;
  PathParts& parts_;
};

/// Russian roulette after the first bounces; `most`: the largest survival probability.
bool EyeTracer::survives(PathState& state, float most) const {
  if (state.bounce + 1 < kRouletteFrom) return true;
  return tempolux::survives(state.throughput, most, state.random.get1(state.bounce, Purpose::roulette));
}

/// Follows a ray to its hit.
void EyeTracer::go_on(const Ray& ray, PathState& state) const {
  state.ray = ray;
  count(1, counts_.bounce, state);
  state.hit = {};
  scene_.tracer.intersect(state.ray, state.hit);
  ++state.bounce;
}

/// Draws the next ray and follows it; u_lobe chooses the event, D or S. times: Vertex::times_diffuse or times_specular.
/// Returns false if the path ends.
bool EyeTracer::scatter(const Vertex& at, float u_lobe, float times, PathState& state) const {
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
  if (next.transmitted && at.drawn) [[unlikely]]
    state.throughput *= at.drawn->color, state.wavelength = at.drawn->nm;
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
bool EyeTracer::scatter_in_medium(const MediumPoint& point, PathState& state) const {
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
  if (state.known.has(LightKind::indirect)) return Passed::ended;
  if (state.inside.any())
    state.throughput *=
        state.inside.transmittance_over(scene_.frame().materials, length(collision.position - state.ray.origin));
  return scatter_in_medium(collision, state) ? Passed::scattered : Passed::ended;
}

/// Takes one sample of the suns (of_sun) or of the other lights, and adds what each lobe scatters, weighed by MIS
/// [Veach 1997 (9.14)], to the layer of the lobe.
void EyeTracer::sample_light(const Vertex& at, const PathState& state, const PixelRandom& random, bool of_sun,
                             Layers& result) const {
  const ShadingPoint& x = at.x;
  const bool has_diffuse = samples_diffuse(at), has_specular = samples_specular(at, state);
  // Rough glass also transmits light from behind. The sample is taken on one side, which is drawn.
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
      of_sun ? scene_.lights.sample_sun(x.surface.position, normal, random.get2(state.bounce, Purpose::sun), light)
             : scene_.lights.sample(x.surface.position, normal, random.get2(state.bounce, Purpose::light_point), light,
                                    sampled_lights());
  if (!found || (behind ? !x.sees_behind(light.wi) : !x.sees(light.wi))) return;
  const Bsdf::Direction from = x.bsdf.along(x.frame.to_local(light.wi));
  const Vec3 wi = from.w;
  Rgb diffuse = has_diffuse ? x.bsdf.eval_diffuse(from, x.eye) * at.remaining_share : Rgb(0.0f);
  Rgb glossy = has_specular ? x.eval_specular(from) : Rgb(0.0f);
  if (behind && at.drawn) [[unlikely]]
    glossy *= at.drawn->color;
  if (!light.only_sampled) {
    const float pdf = light.pdf_solid_angle * share;
    if (has_diffuse) diffuse *= mis_power(pdf, at.times_diffuse * x.bsdf.pdf_diffuse(wi, x.eye));
    if (has_specular) glossy *= mis_power(pdf, at.times_specular * x.pdf_specular(wi));
  }
  if (at.divided_leg > 0 && !light.distant) {
    const auto sampled = [&](float width) {
      return was_sampled(at.divided_leg * width, light.position, x.surface.position);
    };
    if (has_diffuse && sampled(1)) diffuse = Rgb(0.0f);
    if (has_specular && sampled(BrightPoints::width_of(x.gloss_density(wi)))) glossy = Rgb(0.0f);
  }
  if (is_black(diffuse) && is_black(glossy)) return;
  count(1, counts_.shadow, state);
  const Ray shadow = spawn_shadow_ray(x.surface, light.position, light.position_offset);
  const Rgb passed = transmittance(scene_.tracer, shadow, {random.hashed(), state.bounce, way_shadow});
  if (is_black(passed)) return;
  Rgb arriving = state.throughput * light.facing_irradiance * (std::abs(wi.z) / share) * passed;
  if (state.inside.any() && !light.distant)
    arriving *= state.inside.transmittance_over(scene_.frame().materials, length(light.position - x.surface.position));
  result[state.path.after(true).layer()] += arriving * diffuse;
  result[state.path.after(false).layer()] += arriving * glossy;
  if (state.path.after(false).only_specular()) result.mirrored += float(channel_mean(arriving * glossy));
}

/// Decides for which lobes of a surface light of spots is sampled (Vertex::spots). The known light has the spots of the
/// frame's time. At another moment of the shutter spots lie elsewhere, so gloss samples none.
void EyeTracer::choose_spots(Vertex& at, const PathState& state) const {
  if (!known_ || (!known_->lamp_spots && !known_->gloss_spots)) return;
  at.spots = at.known.has(LightKind::indirect) && !at.known.has(LightKind::lamps);
  const bool gloss = !scene_.stored && !state.inside.any();
  at.spots_of_gloss = gloss && at.known.has(LightKind::indirect) && !at.known.has(LightKind::direct) &&
                      !at.known.has(LightKind::caustic);
  at.spots_in_gloss = gloss && state.path.sharp() && samples_specular(at, state);
}

/// Takes one sample of the light of spots. Adds the light that records leave out, if `spots` are
/// KnownLight::lamp_spots, and the light that lobes S of the spot or of this surface reflect.
void EyeTracer::sample_spots(const BrightPoints& spots, const Vertex& at, const PathState& state,
                             const PixelRandom& random, Layers& result) const {
  const ShadingPoint& x = at.x;
  const StoredAt stored(scene_, x);
  const std::optional<BrightPoints::LampSpot> spot =
      spots.lamp_spot(*stored.surface, stored.shading, random.get1(state.bounce, Purpose::light_choice));
  if (!spot) return;
  const float cosine = dot(spot->wi, stored.shading);
  const auto divided = [&](float width) { return known_->samples_spot(spot->distance * width, spot->lamp_distance); };
  Rgb indirect(0.0f), caustic(0.0f), of_matte(0.0f), of_gloss(0.0f);
  if (at.spots || at.spots_of_gloss) {
    const float arrival = x.bsdf.has_specular() ? x.bsdf.arrival_weight(spot->wi, stored.shading) : 1;
    const Rgb reflected = x.bsdf.diffuse_reflectance(x.wo_local) * (kInvPi * at.remaining_share * cosine * arrival);
    if (at.spots && &spots == known_->lamp_spots && divided(1)) indirect = reflected * spot->matte;
    if (at.spots_of_gloss && divided(spot->gloss_width)) caustic = reflected * spot->glossy;
  }
  if (at.spots_in_gloss && x.sees(spot->wi)) {
    const Vec3 wi = x.frame.to_local(spot->wi);
    const float width = BrightPoints::width_of(x.gloss_density(wi));
    if (divided(width)) {
      const Rgb reflected = x.eval_specular(x.bsdf.along(wi)) * cosine;
      of_matte = reflected * spot->matte;
      if (divided(width * spot->gloss_width)) of_gloss = reflected * spot->glossy;
    }
  }
  if (is_black(indirect) && is_black(caustic) && is_black(of_matte) && is_black(of_gloss)) return;
  const PathRandom within(random.hashed().bits(state.bounce, Purpose::gather), state.bounce);
  count(1, counts_.shadow, state);
  const Rgb arriving = state.throughput * transmittance(scene_.tracer, spot->shadow, {within, 0, way_shadow});
  const EyePath diffuse = state.path.after(true), glossy = state.path.after(false);
  result[diffuse.after(true).layer()] += arriving * indirect;
  result[diffuse.after(false).layer()] += arriving * caustic;
  result[glossy.layer()] += arriving * (of_matte + of_gloss);
  if (glossy.after(false).only_specular()) result.mirrored += float(channel_mean(arriving * of_gloss));
}

/// Samples light at a surface. At the first matte surface takes effort_.lit samples, which are added to the part `lit`.
/// Samples of the sun hardly differ from each other. So there is one sample of the sun per camera ray, which is added
/// to the part of the path.
void EyeTracer::add_light(const Vertex& at, const PathState& state) const {
  const bool first_matte = state.path.sharp() && at.x.bsdf.has_diffuse();
  const auto each = [&](const auto& sample) {
    if (!first_matte) sample(state.random, *state.result);
    else
      for (std::uint32_t i = 0; i < effort_.lit; ++i) sample(state.random.of_sample(effort_.lit_first + i), parts_.lit);
  };
  const bool gloss = at.spots_of_gloss || at.spots_in_gloss;
  for (const BrightPoints* const spots :
       {known_ ? known_->lamp_spots : nullptr, known_ ? known_->gloss_spots : nullptr})
    if (spots && (gloss || (at.spots && spots == known_->lamp_spots)))
      each([&](const PixelRandom& random, Layers& result) { sample_spots(*spots, at, state, random, result); });
  if (!samples_diffuse(at) && !samples_specular(at, state)) return;
  if (scene_.suns_apart) sample_light(at, state, state.random, true, *state.result);
  each([&](const PixelRandom& random, Layers& result) { sample_light(at, state, random, false, result); });
}

/// Follows effort_.onward rays from the Lambert lobe of the first matte surface, which add to the part `onward`.
void EyeTracer::go_onward(const Vertex& at, float u_lobe, float times, const PathState& state) const {
  if (at.known.has(LightKind::indirect) && at.known.has(LightKind::caustic) && !known_->lights_are_met) return;
  for (std::uint32_t i = 0; i < effort_.onward; ++i) {
    PathState next = state;
    next.random = state.random.of_sample(effort_.onward_first + i);
    next.result = &parts_.onward;
    if (scatter(at, u_lobe, times, next)) follow(next);
  }
}

/// Adds light of a lamp or of the sky that the path meets.
void EyeTracer::add_met(Rgb light, const PathState& state) const {
  (*state.result)[state.path.layer()] += light;
  if (state.path.only_specular()) state.result->mirrored += float(channel_mean(light));
}

/// Applies the absorption of glass between the last vertex and a surface, and adds the surface's emission.
void EyeTracer::arrive(const SurfacePoint& point, PathState& state) const {
  const SceneFrame& frame = scene_.frame();
  const Vec3 wo = -state.ray.direction;
  const bool front = dot(point.normal_geometric, wo) > 0,
             solid = bounds_solid(frame.materials[point.material], point.plate);
  if (state.inside.any() || (!front && solid))
    state.throughput *= state.inside.transmittance_to(frame.materials, point.material, front, state.hit.t);
  state.cone.advance(state.hit.t);
  state.distance += state.spread * state.hit.t;
  if (state.light_counts() && !was_sampled(state.divided_leg, point.position, state.last.position))
    add_met(state.throughput * weighed_emission(scene_.lights, point, wo, state.last, state.cone.width), state);
}

/// Continues the path from a surface. If the path forks, `state` follows one lobe, and a copy follows the other to its
/// end. Returns false if `state` ends.
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

/// Adds the light that records, points and photons hold for a surface, and notes in `at` which light was added. smooth:
/// the shading normal without a normal map.
void EyeTracer::add_known_light(Vertex& at, Vec3 smooth, const PathState& state) const {
  const KnownLight& known = *known_;
  const ShadingPoint& x = at.x;
  const EyePath& path = state.path;
  Layers& result = *state.result;
  const StoredAt stored_at(scene_, x);
  const float u = state.random.get1(state.bounce, Purpose::gather);
  if (state.known.has(LightKind::bright) && !state.specular)
    at.remaining_share = known.remaining_share(*stored_at.surface, stored_at.geometric, state.distance, u);
  // Radiance per irradiance that the Lambert lobe reflects, times the throughput (Bsdf::diffuse_reflectance).
  const Rgb reflected = state.throughput * x.bsdf.diffuse_reflectance(x.wo_local) * (kInvPi * at.remaining_share);
  // If the camera sees this surface directly, stored light belongs to layer indirect; if it sees the surface by an
  // event S or through a medium, to layer specular or volume.
  const Layer layer = path.after(true).after(true).layer();
  // With bright points, irradiance of points is only the remaining light of a surface. A glossy ray comes from a place
  // that has not sampled bright points, so its path continues.
  if (state.matte || (state.spread > 0 && !known.bright)) {
    if (const std::optional<KnownLight::PointLight> stored =
            known.point_light(*stored_at.surface, stored_at.geometric, state.distance, u)) {
      ++counts_.points_read;
      result[layer] += reflected * stored->irradiance;
      at.known = {LightKind::indirect, LightKind::caustic, LightKind::lamps};
      if (stored->has_direct) at.known.add(LightKind::direct);
      return;
    }
  }
  const auto sample_bright = [&](int samples) {
    if (!known.bright) return;
    GatherCounts rays;
    const PathRandom random(state.random.hashed().bits(state.bounce, Purpose::gather), state.bounce);
    const Bsdf* const coat = x.bsdf.has_specular() ? &x.bsdf : nullptr;
    result[layer] +=
        reflected *
        Rgb(known.bright->arriving({*stored_at.surface, stored_at.shading, coat}, samples, random, rays).irradiance);
    counts_.shadow += rays.shadow_rays;
    at.known.add(LightKind::bright);
  };
  if (known.has_caustic()) {
    at.known.add(LightKind::caustic);
    const Layer caustic = path.after(true).after(false).layer();
    const FootprintLight light = known.caustic(
        stored_at.surface->position, {stored_at.geometric, stored_at.smooth(smooth, x), stored_at.shading, &x.bsdf});
    result[caustic] += reflected * light.irradiance;
    if (caustic == Layer::caustic) parts_.stored_noise.caustic += reflected * light.noise;
  }
  if (state.matte) {
    sample_bright(1);
    return;
  }
  Rgb noise(0.0f);
  if (const std::optional<Rgb> indirect =
          known.indirect(*stored_at.surface, stored_at.geometric, stored_at.shading, &noise)) {
    ++counts_.lookups;
    at.known.add(LightKind::indirect);
    if (!known.lamp_spots) at.known.add(LightKind::lamps);
    result[layer] += reflected * *indirect;
    if (layer == Layer::indirect) parts_.stored_noise.indirect += reflected * noise;
  } else {
    ++counts_.gathered;
    sample_bright(known.bright_samples);
  }
}

/// Adds the light at state.hit and continues the path from there. Returns false if the path ends.
bool EyeTracer::step(PathState& state) const {
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
  float wavelength = state.wavelength;
  std::optional<HeroWavelength> hero;
  const HeroWavelength* drawn = nullptr;
  if (frame.materials[point.material].dispersion > 0) [[unlikely]]
    if (disperses(frame.materials[point.material]) && !(wavelength > 0 || point.plate > 0)) {
      drawn = &hero.emplace(hero_wavelength(state.random.get1(0, Purpose::wavelength)));
      wavelength = drawn->nm;
    }
  const SurfaceMaterial material(frame, point, state.cone.width, wavelength);
  if (material.values().unlit) [[unlikely]] {
    if (state.path.sharp()) add_met(state.throughput * material.values().base_color, state);
    return false;
  }
  const ShadingPoint x(point, -state.ray.direction, material);
  Vertex at{x, material, drawn};
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
  if (state.divided > 0 && x.bsdf.has_diffuse())
    at.divided_leg = state.divided * length(point.position - state.last.position);
  add_light(at, state);
  return !(at.known.has(LightKind::direct) && !x.bsdf.has_specular()) && leave(at, state);
}

void EyeTracer::follow(PathState state) const {
  while (step(state)) {}
}

}  // namespace

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
