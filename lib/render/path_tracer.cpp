#include "lib/render/path_tracer.h"

#include "lib/core/sampling.h"
#include "lib/material/inside.h"
#include "lib/render/known_light.h"
#include "lib/render/shading.h"
#include "lib/transport/emission.h"
#include "lib/transport/media.h"
#include "lib/transport/roulette.h"

namespace tempolux {
namespace {

constexpr std::uint32_t kRouletteFrom = 3;  ///< number of bounces that always survive
/// Below 1, so that paths in a lossless box end, after 500 bounces in the mean.
constexpr float kLargestSurvival = 0.998f;

/// The lobes of a surface for which light is sampled. Where the path forks, both lobes are followed, so each lobe's pdf
/// is the Bsdf's pdf times a factor.
struct SampledLobes {
  bool diffuse, specular;
  float times_diffuse = 1, times_specular = 1;
  float remaining_share = 1;  ///< share of the Lambert lobe's light that is to be added (KnownHere)
  bool forks = false;

  /// probability: Bsdf::fork_probability, in (0, 1). At glass times_diffuse is the reflection's factor and
  /// times_specular that of the transmission.
  void fork(float probability) {
    forks = true;
    times_diffuse = 1 / probability;
    times_specular = 1 / (1 - probability);
  }
};

/// Samples light at x and adds it to the layer of the lobe that scatters it, weighted by MIS. [Veach 1997 (9.14)]
struct LightAdder {
  const RenderScene& scene;
  const ShadingPoint& x;
  SampledLobes lobes;
  const Rgb& throughput;
  const EyePath& path;
  const Inside& inside;
  const PixelRandom& random;
  std::uint32_t bounce;

  bool nothing() const { return !(lobes.diffuse && x.bsdf.has_diffuse()) && !specular(); }
  bool specular() const { return lobes.specular && x.bsdf.has_specular() && !x.bsdf.specular_is_delta(); }
  /// Rough glass also transmits light from behind. Draws one side for this sample; `share` receives the probability of
  /// that side. Returns true for the side behind.
  bool draw_side(float& share) const {
    const float share_behind = x.bsdf.light_share_behind();
    share = 1;
    if (!(share_behind > 0)) [[likely]]
      return false;
    const bool behind = random.get1(bounce, Purpose::light_choice) < share_behind;
    share = behind ? share_behind : 1 - share_behind;
    return behind;
  }
  /// Takes one sample of the lights `from`.
  void add_one(Lights::From from, Layers& result, std::uint64_t& shadow_rays) const {
    float share;
    const bool behind = draw_side(share);
    LightSample light;
    if (scene.lights.sample(x.surface.position, behind ? -x.normal : x.normal,
                            random.get2(bounce, Purpose::light_point), light, from))
      add(light, behind, share, result, shadow_rays);
  }
  /// Takes one sample of a directional light.
  void add_sun(Layers& result, std::uint64_t& shadow_rays) const {
    float share;
    const bool behind = draw_side(share);
    LightSample light;
    if (scene.lights.sample_sun(x.surface.position, behind ? -x.normal : x.normal, random.get1(bounce, Purpose::sun),
                                light))
      add(light, behind, share, result, shadow_rays);
  }
  void add(const LightSample& light, bool behind, float share, Layers& result, std::uint64_t& shadow_rays) const;
};

void LightAdder::add(const LightSample& light, bool behind, float share, Layers& result,
                     std::uint64_t& shadow_rays) const {
  const bool has_diffuse = lobes.diffuse && x.bsdf.has_diffuse(), has_specular = specular();
  if (behind ? !x.sees_behind(light.wi) : !x.sees(light.wi)) return;
  const Bsdf::Direction from = x.bsdf.along(x.frame.to_local(light.wi));
  const Vec3 wi = from.w;
  Rgb diffuse = has_diffuse ? x.bsdf.eval_diffuse(from, x.eye) * lobes.remaining_share : Rgb(0.0f);
  Rgb glossy = has_specular ? x.bsdf.eval_specular(from, x.eye) : Rgb(0.0f);
  if (!light.delta) {
    const float pdf = light.pdf_solid_angle * share;
    if (has_diffuse) diffuse *= mis_power(pdf, lobes.times_diffuse * x.bsdf.pdf_diffuse(wi, x.eye));
    if (has_specular) glossy *= mis_power(pdf, lobes.times_specular * x.bsdf.pdf_specular(wi, x.eye));
  }
  if (is_black(diffuse) && is_black(glossy)) return;
  ++shadow_rays;
  const Ray shadow = spawn_shadow_ray(x.surface, light.position, light.position_offset);
  const float passed = transmittance(scene.tracer, shadow, {random.hashed(), bounce, way_shadow});
  if (!(passed > 0)) return;
  Rgb arriving = throughput * light.facing_irradiance * (std::abs(wi.z) / share) * passed;
  if (inside.any())
    arriving *= inside.transmittance_over(scene.frame().materials, length(light.position - x.surface.position));
  result[path.after(true).layer()] += arriving * diffuse;
  result[path.after(false).layer()] += arriving * glossy;
}

/// What a path remembers of its last event D (a Lambert lobe or a collision in a medium): which light was added there
/// already, and how far its rays have spread since.
struct SinceDiffuse {
  bool matte = false;           ///< there was an event D
  bool caustic_known = false;   ///< light that arrives there by events S was added
  bool indirect_known = false;  ///< light that arrives there by events D was added
  bool specular = false;        ///< the path has had events S since
  /// Bright points were sampled explicitly there: a Lambert lobe that the path meets contributes only the rest.
  bool bright_sampled = false;
  /// m: a ray from a Lambert lobe would have spread as far after this distance. Equal to the path's length since the
  /// last event D; 0 if the path has met only smooth mirrors and glass.
  float distance = 0;
  float spread = 0;  ///< growth of `distance` per metre of path

  void advance(float way) { distance += spread * way; }
  /// Widens the spread by a glossy event of this pdf [1/sr]. A Lambert lobe has 1/pi in its middle, and its rays spread
  /// by one metre per metre.
  void widen(float density) { spread = std::max(spread, std::min(1.0f, 1 / std::sqrt(kPi * density))); }

  /// True if light that the path meets now was not added yet.
  bool light_counts() const { return !(matte && specular && caustic_known); }
};

/// The light that was added at x from records, points and photons; the path must not add it again.
struct KnownHere {
  bool indirect = false, direct = false, caustic = false;
  bool bright_sampled = false;  ///< bright points were sampled explicitly
  float remaining_share =
      1;  ///< share of the Lambert lobe's light that was not sampled explicitly at the path's previous place
};

/// The state of a path on its way.
struct Walk {
  PixelRandom random;
  Layers* result;  ///< the part of the sample that receives the light found from here on
  Ray ray;
  Hit hit;
  RayCone cone;
  Rgb throughput{1.0f};
  EyePath path;
  Inside inside;
  LastScatter last;
  SinceDiffuse since;
  std::uint32_t bounce = 0;
  bool forked = false;
};

/// A surface that a path has reached.
struct Vertex {
  const ShadingPoint& x;
  const SurfaceMaterial& material;
  const KnownHere& here;
};

class EyeTracer {
 public:
  EyeTracer(const RenderScene& scene, const KnownLight* known, const PathEffort& effort, RayCounts& counts,
            PathParts& parts)
      : scene_(scene), known_(known), effort_(effort), counts_(counts), parts_(parts) {}
  void follow(Walk walk) const;

 private:
  enum class Passed { through, scattered, ended };
  Passed pass_media(const Media& media, Walk& walk) const;
  bool scatter_in_medium(const MediumPoint& point, Walk& walk) const;
  bool scatter(const Vertex& at, float u_lobe, float times, Walk& walk) const;
  bool survives(Walk& walk, float most) const;
  void go_on(const Ray& ray, Walk& walk) const;
  void add_light(const ShadingPoint& x, SampledLobes lobes, bool first_matte, const Walk& walk) const;
  void arrive(const SurfacePoint& point, Walk& walk) const;
  KnownHere add_known_light(const ShadingPoint& x, Vec3 smooth, const Walk& walk) const;
  bool leave(const Vertex& at, const SampledLobes& lobes, Walk& walk) const;
  bool step(Walk& walk) const;
  void go_onward(const Vertex& at, float u_lobe, float times, const Walk& walk) const;
  void count(std::uint64_t rays, std::uint64_t& as, const Walk& walk) const {
    as += rays;
    if (walk.result == &parts_.onward)
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
bool EyeTracer::survives(Walk& walk, float most) const {
  if (walk.bounce + 1 < kRouletteFrom) return true;
  return tempolux::survives(walk.throughput, most, walk.random.get1(walk.bounce, Purpose::roulette));
}

void EyeTracer::go_on(const Ray& ray, Walk& walk) const {
  walk.ray = ray;
  count(1, counts_.bounce, walk);
  walk.hit = {};
  scene_.tracer.intersect(walk.ray, walk.hit);
  ++walk.bounce;
}

/// Draws the next ray: an event D or S by u_lobe. times: the lobe's probability over the Bsdf's. Returns false if the
/// path ends.
bool EyeTracer::scatter(const Vertex& at, float u_lobe, float times, Walk& walk) const {
  const auto& [x, material, here] = at;
  const Bsdf::Sample next = x.bsdf.sample(x.eye, u_lobe, walk.random.get2(walk.bounce, Purpose::scatter));
  if (is_black(next.weight) || (here.direct && next.diffuse)) return false;
  const Vec3 wi = x.frame.to_world(next.wi);
  if (next.transmitted ? !x.sees_behind(wi) : !x.sees(wi)) return false;
  walk.throughput *= next.weight * (1 / times);
  walk.path.scatter(next.diffuse);
  if (next.diffuse) {
    walk.throughput *= here.remaining_share;
    walk.since = {true, here.caustic, here.indirect, false, here.bright_sampled, 0, 1};
  } else {
    walk.since.specular = true;
    walk.since.widen(x.bsdf.gloss_density(next.wi, x.eye));
  }
  const bool front = dot(x.surface.normal_geometric, walk.ray.direction) < 0;
  if (!next.diffuse && is_solid_glass(material)) walk.inside.scatter(x.surface.material, front, next.transmitted);
  if (!survives(walk, kLargestSurvival)) return false;

  LastScatter& last = walk.last;
  last.weighed = !next.delta;
  if (next.diffuse) walk.cone = {};
  last.position = x.surface.position;
  last.normal = next.transmitted ? -x.normal : x.normal;
  last.light_share = next.transmitted ? x.bsdf.light_share_behind() : 1 - x.bsdf.light_share_behind();
  last.from = scene_.suns_apart ? Lights::From::not_suns : Lights::From::all;
  last.pdf_solid_angle =
      times * (next.diffuse ? x.bsdf.pdf_diffuse(next.wi, x.eye) : x.bsdf.pdf_specular(next.wi, x.eye));
  go_on(spawn_ray(x.surface, wi), walk);
  return true;
}

/// Scatters in a medium: samples a light, applies Russian roulette and draws a new ray. Returns false if the path ends.
bool EyeTracer::scatter_in_medium(const MediumPoint& point, Walk& walk) const {
  walk.path.scatter_in_medium();
  walk.since = {true, false, false, false, false, 0, 1};
  walk.cone = {};
  walk.throughput *= point.albedo;
  if (is_black(walk.throughput)) return false;
  const WayBits bits{walk.random.hashed(), walk.bounce, way_shadow_of_medium};
  std::uint64_t shadow_rays = 0;
  (*walk.result)[walk.path.layer()] +=
      walk.throughput * scattered_lamp_light(scene_.tracer, scene_.lights, point,
                                             walk.random.get2(walk.bounce, Purpose::light_point), true, bits,
                                             shadow_rays);
  count(shadow_rays, counts_.shadow, walk);
  if (!survives(walk, kLargestSurvivalInMedia)) return false;
  const Vec3 travel = sample_hg(point.g, point.travel, walk.random.get2(walk.bounce, Purpose::phase));
  walk.last = {true, point.position, {}, pdf_hg(point.g, point.travel, travel), 1};
  go_on({point.position, travel, 0, INFINITY}, walk);
  return true;
}

/// Passes the media between the last vertex and walk.hit.
EyeTracer::Passed EyeTracer::pass_media(const Media& media, Walk& walk) const {
  const float way = walk.hit.surface == kNone ? INFINITY : walk.hit.t;
  if (known_ && walk.bounce == 0) {
    const auto passed = float(std::exp(-media.optical_depth(walk.ray.origin, walk.ray.direction, way)));
    walk.throughput *= passed;
    parts_.own.coverage = 1 - passed;
    return Passed::through;
  }
  MediumPoint collision;
  if (!collides(media, walk.ray, way, walk.random.hashed(), walk.bounce, collision)) return Passed::through;
  if (walk.bounce == 0) parts_.own.coverage = 1;
  if (walk.since.indirect_known) return Passed::ended;
  if (walk.inside.any())
    walk.throughput *=
        walk.inside.transmittance_over(scene_.frame().materials, length(collision.position - walk.ray.origin));
  return scatter_in_medium(collision, walk) ? Passed::scattered : Passed::ended;
}

/// Samples light at a surface. At the first matte surface effort_.lit samples are added to the part `lit`. Samples of
/// the sun hardly differ from each other, so one per camera ray is enough; it belongs to the path's own part.
void EyeTracer::add_light(const ShadingPoint& x, SampledLobes lobes, bool first_matte, const Walk& walk) const {
  const auto adder = [&](const PixelRandom& random) {
    return LightAdder{scene_, x, lobes, walk.throughput, walk.path, walk.inside, random, walk.bounce};
  };
  if (adder(walk.random).nothing()) return;
  std::uint64_t rays = 0;
  if (scene_.suns_apart) adder(walk.random).add_sun(*walk.result, rays);
  const Lights::From from = scene_.suns_apart ? Lights::From::not_suns : Lights::From::all;
  if (!first_matte) adder(walk.random).add_one(from, *walk.result, rays);
  else
    for (std::uint32_t i = 0; i < effort_.lit; ++i) {
      const PixelRandom random = walk.random.of_sample(effort_.lit_first + i);
      adder(random).add_one(from, parts_.lit, rays);
    }
  count(rays, counts_.shadow, walk);
}

/// Follows effort_.onward rays from the Lambert lobe of the first matte surface: the part `onward`.
void EyeTracer::go_onward(const Vertex& at, float u_lobe, float times, const Walk& walk) const {
  if (at.here.indirect && at.here.caustic && !known_->lights_are_met) return;
  for (std::uint32_t i = 0; i < effort_.onward; ++i) {
    Walk next = walk;
    next.random = walk.random.of_sample(effort_.onward_first + i);
    next.result = &parts_.onward;
    if (scatter(at, u_lobe, times, next)) follow(next);
  }
}

/// Arrival at a surface: applies the absorption of glass on the way and adds the surface's emission.
void EyeTracer::arrive(const SurfacePoint& point, Walk& walk) const {
  const SceneFrame& frame = scene_.frame();
  const Vec3 wo = -walk.ray.direction;
  const bool front = dot(point.normal_geometric, wo) > 0;
  if (walk.inside.any() || (!front && is_solid_glass(frame.materials[point.material])))
    walk.throughput *= walk.inside.transmittance_to(frame.materials, point.material, front, walk.hit.t);
  walk.cone.advance(walk.hit.t);
  walk.since.advance(walk.hit.t);
  if (walk.since.light_counts())
    (*walk.result)[walk.path.layer()] +=
        walk.throughput * weighed_emission(scene_.lights, point, wo, walk.last, walk.cone.width);
}

/// Follows the rays that leave a surface: one, or one for each lobe where the path forks. Returns false if `walk` ends.
bool EyeTracer::leave(const Vertex& at, const SampledLobes& lobes, Walk& walk) const {
  const ShadingPoint& x = at.x;
  const bool first_matte = walk.path.sharp() && x.bsdf.has_diffuse();
  float u_lobe = walk.random.get1(walk.bounce, Purpose::lobe), times = 1;
  if (lobes.forks) {
    const float diffuse = 1 / lobes.times_diffuse;
    walk.forked = true;
    Walk branch = walk;
    if (scatter(at, std::min(kOneMinusEpsilon, diffuse + (1 - diffuse) * u_lobe), lobes.times_specular, branch))
      follow(branch);
    u_lobe *= diffuse;
    times = lobes.times_diffuse;
  }
  if (first_matte && x.bsdf.draws_diffuse(x.eye, u_lobe)) {
    go_onward(at, u_lobe, times, walk);
    return false;
  }
  return scatter(at, u_lobe, times, walk);
}

/// Adds the light that records, points and photons hold for x. smooth: the shading normal without a normal map.
KnownHere EyeTracer::add_known_light(const ShadingPoint& x, Vec3 smooth, const Walk& walk) const {
  const KnownLight& known = *known_;
  const SinceDiffuse& since = walk.since;
  const EyePath& path = walk.path;
  Layers& result = *walk.result;
  const float u = walk.random.get1(walk.bounce, Purpose::gather);
  KnownHere here;
  if (since.bright_sampled && !since.specular)
    here.remaining_share = known.remaining_share(x.surface, x.normal_geometric, since.distance, u);
  // The Lambert lobe's total for uniform light is rho (1 - A_S(wo)), see bsdf.h.
  const Rgb reflected = walk.throughput * x.bsdf.diffuse_reflectance(x.wo_local.z) * (kInvPi * here.remaining_share);
  // The layer indirect, or the layer of the surface that the path has seen before.
  const Layer layer = path.after(true).after(true).layer();
  // With bright points, a point's irradiance represents only the remaining light. A glossy ray has not sampled bright
  // points, so the path continues.
  if (since.matte || (since.spread > 0 && !known.bright)) {
    if (const std::optional<KnownLight::PointLight> stored =
            known.point_light(x.surface, x.normal_geometric, since.distance, u)) {
      ++counts_.points_read;
      result[layer] += reflected * stored->irradiance;
      return {true, stored->has_direct, true, false, here.remaining_share};
    }
  }
  const auto sample_bright = [&](int samples) {
    if (!known.bright) return;
    GatherCounts rays;
    const PathRandom random(walk.random.hashed().bits(walk.bounce, Purpose::gather), walk.bounce);
    const Bsdf* const coat = x.bsdf.has_specular() ? &x.bsdf : nullptr;
    result[layer] +=
        reflected * Rgb(known.bright->arriving({x.surface, x.normal, coat}, samples, random, rays).irradiance);
    counts_.shadow += rays.shadow_rays;
    here.bright_sampled = true;
  };
  if (known.has_caustic()) {
    here.caustic = true;
    result[path.after(true).after(false).layer()] +=
        reflected * known.caustic(x.surface.position, {x.normal_geometric, x.facing(smooth), x.normal, &x.bsdf});
  }
  if (since.matte) {
    sample_bright(1);
    return here;
  }
  Rgb noise(0.0f);
  if (const std::optional<Rgb> indirect = known.indirect(x.surface, x.normal_geometric, x.normal, &noise)) {
    ++counts_.lookups;
    here.indirect = true;
    result[layer] += reflected * *indirect;
    if (layer == Layer::indirect) parts_.known_noise += reflected * noise;
  } else {
    ++counts_.gathered;
    sample_bright(known.bright_samples);
  }
  return here;
}

/// Moves the path from one vertex to the next. Returns false if the path ends.
bool EyeTracer::step(Walk& walk) const {
  const SceneFrame& frame = scene_.frame();
  if (const Media* const media = frame.media.get()) [[unlikely]] {
    const Passed media_event = pass_media(*media, walk);
    if (media_event != Passed::through) return media_event == Passed::scattered;
  }
  Layers& result = *walk.result;
  if (walk.hit.surface == kNone) {
    if (scene_.lights.has_environment() && walk.since.light_counts())
      result[walk.path.layer()] += walk.throughput * weighed_environment(scene_.lights, walk.ray.direction, walk.last);
    return false;
  }
  parts_.own.coverage = 1;
  SurfacePoint point = scene_.tracer.surface_point(walk.hit);
  arrive(point, walk);
  // True if only light by events S may still be added.
  const bool only_specular = walk.since.indirect_known;
  if (only_specular && walk.since.caustic_known) return false;

  const Vec3 smooth = point.normal;
  const SurfaceMaterial material(frame, point, walk.cone.width);
  if (material.values().unlit) [[unlikely]] {
    if (walk.path.sharp()) result[walk.path.layer()] += walk.throughput * material.values().base_color;
    return false;
  }
  const ShadingPoint x(point, -walk.ray.direction, material);
  KnownHere here{only_specular, only_specular, only_specular};
  if (known_ && !only_specular && x.bsdf.has_diffuse()) here = add_known_light(x, smooth, walk);
  SampledLobes lobes{!here.direct, !(walk.since.matte && walk.since.caustic_known)};
  lobes.remaining_share = here.remaining_share;
  if (known_ && known_->forks() && !walk.forked && walk.path.sharp() && x.bsdf.forks())
    lobes.fork(std::clamp(x.bsdf.fork_probability(x.eye), 0x1p-20f, 1 - 0x1p-20f));
  add_light(x, lobes, walk.path.sharp() && x.bsdf.has_diffuse(), walk);
  return !(here.direct && !x.bsdf.has_specular()) && leave({x, material, here}, lobes, walk);
}

void EyeTracer::follow(Walk walk) const {
  while (step(walk)) {}
}

}  // namespace

PathParts trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const Hit& first, const PixelRandom& random,
                         const KnownLight* known, RayCounts& counts, RayCone cone, const PathEffort& effort) {
  PathParts parts;
  ++counts.camera;
  EyeTracer(scene, known, effort, counts, parts)
      .follow({random, &parts.own, camera_ray, first, cone, Rgb(1.0f), {}, {}, {}, {}});
  return parts;
}

Layers trace_eye_path(const RenderScene& scene, const Ray& camera_ray, const PixelRandom& random,
                      const KnownLight* known, RayCounts& counts, RayCone cone) {
  Hit first;
  scene.tracer.intersect(camera_ray, first);
  return trace_eye_path(scene, camera_ray, first, random, known, counts, cone, effort_of(random.sample())).sum();
}

}  // namespace tempolux
