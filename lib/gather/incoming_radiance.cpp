#include "lib/gather/incoming_radiance.h"

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/sampling.h"
#include "lib/gather/bright_points.h"
#include "lib/material/diffuse_transmission.h"
#include "lib/material/inside.h"
#include "lib/material/seen_side.h"
#include "lib/material/surface_material.h"
#include "lib/transport/direct_light.h"
#include "lib/transport/emission.h"
#include "lib/transport/media.h"
#include "lib/transport/light_kinds.h"
#include "lib/transport/roulette.h"
#include "lib/transport/specular_chain.h"

namespace tempolux {
namespace {

/// Largest number of events of one ray. Russian roulette ends all but the share .95^512 = 4e-12 of the rays before.
constexpr int kDeepest = 512;
constexpr float kLargestSurvival = 0.95f;
/// Offset that separates the random numbers of media from the random numbers of events at surfaces.
constexpr std::uint64_t kMediaNumbers = std::uint64_t(1) << 32;
/// The same for the choice of a side.
constexpr std::uint64_t kSideNumbers = kMediaNumbers + 2;
constexpr std::size_t kAtOnce = 32;  ///< rays that are processed together
/// Light that is known at a surface where a gather ray starts, if a point represents the surface or records do.
constexpr LightKinds kCausticKnown{LightKind::caustic};

}  // namespace

/// The surface at the end of a ray.
struct IncomingRadiance::Met {
  SurfacePoint hit;
  Vec3 wo;                       ///< unit, towards the start of the ray
  Vec3 geometric;                ///< geometric normal on the side of wo
  SideChoice side;               ///< from which the ray goes on; on the far side wo and geometric are turned round
  float distance = INFINITY;     ///< m: length of the path since the start of the gather ray
  float leg = INFINITY;          ///< m: length of the path's last straight part
  const Bsdf* bsdf = nullptr;    ///< null: the ray met no surface
  std::optional<Bsdf> textured;  ///< storage for a Bsdf of a material with textures, of a plate, of a far side

  // follow() has an array of hits. Without this constructor the array would be cleared, which
  // takes 2 % of the time of records.
  Met() {}
};

/// A gather ray, or a ray that continues it from a hit. All rays of one depth are followed together.
struct IncomingRadiance::Further {
  Ray ray;
  std::uint64_t key = 0;
  Rgb weight{0.0f};    ///< radiance along this ray times this factor adds to the radiance along the gather ray
  std::size_t of = 0;  ///< index of the gather ray
  /// Light at the ray's start that was added. Without `caustic`, lights that the ray meets after events S count.
  LightKinds known{};
  float phase = 0;  ///< pdf [1/sr] with which a medium scattered the ray; 0: a surface scattered the path last
  /// Width of the lobe that sent the ray (BrightPoints::lobe_width), if bright points were sampled explicitly for this
  /// lobe at the ray's start: the ray's hit then contributes only the remaining share. 0: not sampled.
  float sampled_lobe = 0;
  bool specular = false;  ///< true if events S have happened since the ray's start; passing a pane straight is none
  float leg = 0;          ///< m: length of the straight part that ends at the pane that the ray has passed; else 0
  Inside inside{};        ///< the solids of glass that the ray has entered since its start

  /// The ray that continues straight behind a pane. `before` [m]: length of the straight part that ends at the pane.
  Further behind_pane(Rgb passed, float before) const {
    Further after = *this;
    after.key = mix64(key + 2);
    after.weight *= passed;
    after.leg = before;
    return after;
  }
  /// The ray after another event S. `lobe`: sampled_lobe of the new ray.
  Further after_specular(Rgb scattered, float lobe) const {
    Further after = behind_pane(scattered, 0);
    after.sampled_lobe = lobe;
    after.phase = 0;
    after.specular = true;
    return after;
  }
  LastScatter scattering() const { return {phase > 0, ray.origin, {}, phase, 1, Lights::From::all}; }
};

/// The results to which hits add.
struct IncomingRadiance::Gathered {
  GatherCounts& counts;
  std::vector<Further>& further;      ///< rays of the next depth
  std::span<RadianceSource> sources;  ///< by gather ray; may be empty

  RadianceSource* source_of(const Further& from) const { return sources.empty() ? nullptr : &sources[from.of]; }
};

IncomingRadiance::IncomingRadiance(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                                   const BrightPoints* bright)
    : tracer_(tracer), lights_(lights), points_(points), bright_(bright) {
  for (const Material& material : tracer.frame().materials)
    bsdfs_.push_back({Bsdf(material, false), Bsdf(material, true)});
}

Bsdf IncomingRadiance::bsdf_at(const SurfacePoint& place, Vec3 normal) const {
  Met met;
  met.hit = place;
  look_at(normal, met);
  return *met.bsdf;
}

/// Fills in the rest of `met` if met.hit is known. `leg` [m]: length of the last straight part; `before` [m]: length of
/// the path before that part. Evaluates the material's textures at the hit; a normal map changes met.hit.normal.
/// At a surface that transmits diffusely, draws the side from which the ray goes on, by random numbers of `key`.
inline void IncomingRadiance::meet(Vec3 wo, float leg, float before, std::uint64_t key, Met& met) const {
  met.leg = leg;
  met.distance = before + leg;
  met.side = {};
  if (transmits_diffusely(tracer_.frame().materials[met.hit.material])) [[unlikely]] {
    SurfacePoint smooth = met.hit;
    look_at(wo, met);
    draw_side(key, smooth, met);
  } else {
    look_at(wo, met);
  }
}

/// Sets Met::bsdf, wo and geometric.
inline void IncomingRadiance::look_at(Vec3 wo, Met& met) const {
  const float cosine = dot(met.hit.normal_geometric, wo);
  met.bsdf = &bsdfs_[met.hit.material][cosine > 0];
  if (tracer_.frame().materials[met.hit.material].textures || met.hit.plate > 0) [[unlikely]] {
    const SurfaceMaterial material(tracer_.frame(), met.hit);
    met.bsdf =
        &met.textured.emplace(material, cosine > 0, SeenSide(met.hit, wo).frame, Carries::radiance, met.hit.plate);
  }
  met.wo = wo;
  met.geometric = cosine < 0 ? -met.hit.normal_geometric : met.hit.normal_geometric;
}

/// Draws the side from which a ray goes on. smooth: the hit without its normal map.
void IncomingRadiance::draw_side(std::uint64_t key, SurfacePoint& smooth, Met& met) const {
  const SurfaceMaterial material(tracer_.frame(), smooth);
  met.side = choose_side(*met.bsdf, SeenSide(met.hit, met.wo).wo_local, material,
                         PathRandom(key, kSideNumbers).get1(0, Purpose::side));
  if (!met.side.far_side) return;
  met.wo = -met.wo;
  met.geometric = -met.geometric;
  met.bsdf = &met.textured.emplace(on_far_side(material), dot(met.hit.normal_geometric, met.wo) > 0,
                                   SeenSide(met.hit, met.wo).frame, Carries::radiance);
}

/// Calls take(i, met, point) for each ray i that meets a surface, where `point` is the point that represents the hit,
/// or nullptr. Calls take_medium(i, collision, distance) for rays that a medium scatters before they meet a surface,
/// with random numbers of key(i), and miss(i) for rays that leave the scene.
template <class Take, class Key, class TakeMedium, class Miss>
void IncomingRadiance::follow(std::span<const Ray> rays, GatherCounts& counts, const Take& take, const Key& key,
                              const TakeMedium& take_medium, const Miss& miss) const {
  const Media* const media = tracer_.frame().media.get();
  std::array<Hit, kAtOnce> hits;
  std::array<Met, kAtOnce> met;
  std::array<PointLookup::Question, kAtOnce> questions;
  std::array<std::uint32_t, kAtOnce> answers;
  for (std::size_t first = 0; first < rays.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, rays.size() - first);
    tracer_.intersect(rays.subspan(first, count), std::span(hits).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      met[i].bsdf = nullptr;
      const Ray& ray = rays[first + i];
      if (media) [[unlikely]] {
        MediumPoint collision;
        if (collides(*media, ray, hits[i].surface == kNone ? INFINITY : hits[i].t,
                     PathRandom(key(first + i), kMediaNumbers), 0, collision)) {
          take_medium(first + i, collision, length(collision.position - ray.origin));
          continue;
        }
      }
      if (hits[i].surface == kNone) {
        miss(first + i);
        continue;
      }
      tracer_.surface_points(std::span(hits).subspan(i, 1), &met[i].hit);
      meet(-ray.direction, length(met[i].hit.position - ray.origin), 0, key(first + i), met[i]);
      if (met[i].bsdf->has_diffuse()) questions[i] = points_.ask(met[i].hit.position, met[i].geometric);
    }
    const auto reads_point = [&](std::size_t i) { return met[i].bsdf && met[i].bsdf->has_diffuse(); };
    for (std::size_t i = 0; i < count; ++i)
      if (reads_point(i)) answers[i] = points_.answer(questions[i]);
    for (std::size_t i = 0; i < count; ++i)
      if (met[i].bsdf) take(first + i, met[i], reads_point(i) ? points_.read(questions[i], answers[i]) : nullptr);
  }
  counts.rays += rays.size();
}

void IncomingRadiance::operator()(std::span<const Ray> rays, std::span<const std::uint64_t> keys,
                                  std::span<Rgb> radiance, std::span<float> distance, GatherCounts& counts,
                                  std::span<RadianceSource> sources, Start start) const {
  thread_local std::vector<Further> now, next;
  thread_local std::vector<Ray> now_rays;
  std::fill(radiance.begin(), radiance.end(), Rgb(0.0f));
  std::fill(distance.begin(), distance.end(), INFINITY);
  std::fill(sources.begin(), sources.end(), RadianceSource{});
  next.clear();
  for (std::size_t i = 0; i < rays.size(); ++i)
    next.push_back({rays[i], keys[i], Rgb(1.0f), i, start == Start::medium ? LightKinds{} : kCausticKnown, 0,
                    bright_ ? 1.0f : 0.0f});
  const Gathered to{counts, next, sources};
  for (int depth = 0; !next.empty(); ++depth) {
    std::swap(now, next);
    next.clear();
    now_rays.clear();
    for (const Further& f : now) now_rays.push_back(f.ray);
    follow(
        now_rays, counts,
        [&](std::size_t i, const Met& met, const PointLookup::Light* point) {
          const Further& from = now[i];
          if (depth == 0) distance[i] = met.distance;
          radiance[from.of] += from.weight * reflected(met, point, from, depth, to);
          if (from.phase > 0)
            radiance[from.of] +=
                from.weight * weighed_emission(lights_, met.hit, -from.ray.direction, from.scattering(), 0);
        },
        [&](std::size_t i) { return now[i].key; },
        [&](std::size_t i, const MediumPoint& collision, float way) {
          const Further& from = now[i];
          if (depth == 0) distance[i] = way;
          radiance[from.of] += from.weight * scattered_in_media(collision, from, to);
        },
        [&](std::size_t i) {  // rays of surfaces do not count the environment: surfaces sample it directly
          const Further& from = now[i];
          if (from.phase > 0 && lights_.has_environment())
            radiance[from.of] += from.weight * weighed_environment(lights_, from.ray.direction, from.scattering());
        });
  }
}

/// Radiance [W/m^2/sr] that the surface at a ray's end reflects, without emission. The Lambert lobe reads the point
/// that represents the hit. If no point does, if indirect light around the point is not uniform, or if a first hit is
/// close, the ray continues, and `to.further` receives it. The other lobes are followed along one sampled direction.
Rgb IncomingRadiance::reflected(const Met& met, const PointLookup::Light* point, const Further& from, int depth,
                                const Gathered& to) const {
  if (met.side.is_plain()) [[likely]]
    return reflected_on_side(met, point, from, depth, to);
  Further drawn = from;
  drawn.weight *= 1 / met.side.chance;
  // Bright points light lobes that reflect. Light that is transmitted is not divided.
  if (met.side.far_side) drawn.sampled_lobe = 0;
  if (RadianceSource* const source = to.source_of(from)) source->partial = true;
  return reflected_on_side(met, point, drawn, depth, to) / met.side.chance;
}

/// reflected() on the side from which the ray goes on.
inline Rgb IncomingRadiance::reflected_on_side(const Met& met, const PointLookup::Light* point, const Further& from,
                                               int depth, const Gathered& to) const {
  const Bsdf& bsdf = *met.bsdf;
  const bool specular = bsdf.has_specular();
  std::optional<SeenSide> side;
  if (specular) side.emplace(met.hit, met.wo);
  const PathRandom random(from.key, std::uint64_t(depth));
  RadianceSource* const source = to.source_of(from);
  if (source) {
    source->mover |= met.hit.surface >= tracer_.frame().static_count;
    if (depth == 0 && point) source->point = point->point;
    source->partial |= depth > 0;
  }
  Rgb result{0.0f};
  if (bsdf.has_diffuse()) {
    const Rgb scale = bsdf.diffuse_reflectance(side ? side->wo_local : Vec3{0, 0, 1}) * kInvPi;
    // Most hits are not close whatever the random number is, so the first test needs none.
    const bool near = point && depth == 0 && PointLookup::is_near(*point, met.distance, 1) &&
                      PointLookup::is_near(*point, met.distance, random.get1(0, Purpose::gather));
    if (point && !near && points_.is_uniform_indirect(*point)) {
      ++to.counts.points_read;
      const bool even = lights_.empty() || points_.is_uniform(*point);
      if (source) source->partial |= !even;
      const float remaining = remaining_share(met, point, from);
      const IrradiancePoint& stored = points_.point(*point);
      const Rgb light =
          even ? point->all
               : stored.indirect + stored.caustic +
                     sampled_light(met, SeenSide(met.hit, met.wo), point, from.sampled_lobe, random, to.counts);
      result = scale * light * remaining;
      if (source) source->noise += from.weight * scale * stored.noise * remaining;
    } else {
      const Rgb kept = scale * (near ? 1.0f : remaining_share(met, point, from));
      result = kept * scattered(met, point, from, kept, depth, to);
      if (source) source->partial = true;
    }
  }
  if (!specular || depth >= kDeepest) return result;
  return result + reflected_specular(met, *side, from, depth, to);
}

/// The part of reflected() by the lobes other than Lambert's: one sampled direction, with Russian roulette on its
/// weight.
Rgb IncomingRadiance::reflected_specular(const Met& met, const SeenSide& side, const Further& from, int depth,
                                         const Gathered& to) const {
  const Bsdf& bsdf = *met.bsdf;
  const PathRandom random(from.key, std::uint64_t(depth));
  RadianceSource* const source = to.source_of(from);
  Rgb result{0.0f};
  const MaterialValues& material = tracer_.frame().materials[met.hit.material];
  const Bsdf::Direction wo = bsdf.along(side.wo_local);
  const float choice = random.get1(2, Purpose::lobe);
  const bool sampled =
      bright_ && !(material.transmission > 0) && !bsdf.specular_is_delta() && !bsdf.draws_diffuse(wo, choice);
  if (sampled) {  // event S is drawn with the probability by which the light is divided
    const BrightLight light = bright_->arriving({met.hit, side.normal, &bsdf, true, met.wo}, 1, random, to.counts);
    result += Rgb(light.irradiance / double(1 - bsdf.fork_probability(wo)));
    if (source) source->partial = true;
  }
  const Scattered event(bsdf, side.frame, wo, choice, random.get2(2, Purpose::scatter));
  const Bsdf::Sample& next = event.sample;
  const Vec3 travel = event.travel;
  if (next.diffuse || is_black(next.weight)) return result;
  if ((next.transmitted ? -1.0f : 1.0f) * dot(travel, met.geometric) <= 0) return result;
  Rgb weight = next.weight;
  if (!survives(weight, kLargestSurvival, random.get1(2, Purpose::roulette))) return result;
  Further after = next.straight ? from.behind_pane(weight, met.leg)
                                : from.after_specular(
                                      weight, sampled && !next.delta ? BrightPoints::lobe_width(bsdf, next.wi, wo) : 0);
  event.pass(met.hit, material, dot(met.hit.normal_geometric, met.wo) > 0, after.inside);
  if (source) source->partial = true;
  return result + weight * radiance_after_specular(met.hit, travel, met.distance, after, depth + 1, to);
}

/// Radiance [W/m^2/sr] along a ray that continues from `start` after an event S or behind a pane. `distance` [m]:
/// length of the path before `start`.
Rgb IncomingRadiance::radiance_after_specular(const SurfacePoint& start, Vec3 travel, float distance, Further from,
                                              int depth, const Gathered& to) const {
  const std::vector<Material>& materials = tracer_.frame().materials;
  Hit hit;
  ++to.counts.rays;
  const Ray ray = spawn_ray(start, travel);
  const bool meets = tracer_.intersect(ray, hit);
  if (const Media* const media = tracer_.frame().media.get()) [[unlikely]] {
    MediumPoint collision;
    if (collides(*media, ray, meets ? hit.t : INFINITY, PathRandom(from.key, kMediaNumbers), 0, collision)) {
      const Rgb left = from.inside.transmittance_over(materials, length(collision.position - start.position));
      from.weight *= left;
      return left * scattered_in_media(collision, from, to);
    }
  }
  const bool sees_lamps = from.phase > 0 || (!from.known.has(LightKind::caustic) && from.specular);
  if (!meets)
    return sees_lamps && lights_.has_environment() ? weighed_environment(lights_, travel, from.scattering())
                                                   : Rgb(0.0f);
  Met met;
  met.hit = tracer_.surface_point(hit);
  const float on = length(met.hit.position - start.position);
  const Rgb left = from.inside.transmittance_over(materials, on);
  from.weight *= left;
  meet(-travel, from.leg + on, distance - from.leg, from.key, met);
  const Rgb emitted = sees_lamps ? weighed_emission(lights_, met.hit, -travel, from.scattering(), 0) : Rgb(0.0f);
  const PointLookup::Light* point = met.bsdf->has_diffuse() ? points_.find(met.hit.position, met.geometric) : nullptr;
  return left * (emitted + reflected(met, point, from, depth, to));
}

/// Radiance [W/m^2/sr] that a medium scatters back along a ray at its collision, from one light sample. `to.further`
/// receives the ray that continues. This ray also counts lights that it meets, weighted by MIS, and lights that it sees
/// by events S, because no point holds their light at the collision.
Rgb IncomingRadiance::scattered_in_media(const MediumPoint& at, const Further& from, const Gathered& to) const {
  if (RadianceSource* const source = to.source_of(from)) source->partial = source->mover = true;
  const PathRandom random(from.key, kMediaNumbers + 1);
  Rgb light{0.0f};
  if (!lights_.empty())
    light = at.albedo *
            scattered_lamp_light(tracer_, lights_, at,
                                 {random.get2(1, Purpose::light_point), true, {random, 1, way_shadow_of_medium}},
                                 to.counts.shadow_rays);
  Rgb weight = from.weight * at.albedo;
  if (!survives(weight, kLargestSurvivalInMedia, random.get1(1, Purpose::roulette))) return light;
  const Vec3 travel = sample_hg(at.g, at.travel, random.get2(1, Purpose::phase));
  to.further.push_back({{at.position, travel, 0, INFINITY},
                        mix64(from.key + 1),
                        weight,
                        from.of,
                        {},
                        pdf_hg(at.g, at.travel, travel),
                        0});
  return light;
}

/// Irradiance [W/m^2] at a hit from which the ray continues. The light along the continued ray is not included; the ray
/// is added to `to.further`. Caustic light is read from the point that represents the hit. Direct light is read from
/// the point, too, if it is uniform around the point and the hit is at least about a spacing away; otherwise a light
/// sample estimates it. If there are bright points, one explicit sample is added. If no point represents the hit, the
/// continued ray finds all light except direct light.
Rgb IncomingRadiance::scattered(const Met& met, const PointLookup::Light* point, const Further& from, Rgb scale,
                                int depth, const Gathered& to) const {
  const PathRandom random(from.key, std::uint64_t(depth));
  ++(point ? to.counts.near_hits : to.counts.unanswered);
  const SeenSide side(met.hit, met.wo);
  Rgb irradiance{0.0f};
  if (point) irradiance = points_.point(*point).caustic;
  if (point && points_.is_uniform(*point) &&
      met.distance >= points_.spacing() * (0.5f + random.get1(0, Purpose::gather)))
    irradiance += points_.point(*point).direct;
  else irradiance += sampled_light(met, side, point, from.sampled_lobe, random, to.counts);
  if (bright_) {
    const Bsdf* const coat = met.bsdf->has_specular() ? met.bsdf : nullptr;
    irradiance += Rgb(bright_->arriving({met.hit, side.normal, coat, true}, 1, random, to.counts).irradiance);
  }
  // Each hit has its own random numbers, so that the errors of neighbouring cells are independent: Hemisphere::noise
  // estimates a record's variance from the differences of neighbouring cells.
  const Vec3 drawn = sample_hemisphere_cos(random.get2(1, Purpose::scatter)), travel = side.frame.to_world(drawn);
  if (!(dot(travel, met.geometric) > 0)) return irradiance;
  Rgb weight = from.weight * scale * (kPi * met.bsdf->arrival_weight(drawn));
  if (depth > 0 && !survives(weight, kLargestSurvival, random.get1(1, Purpose::roulette))) return irradiance;
  to.further.push_back({spawn_ray(met.hit, travel), mix64(from.key + 1), weight, from.of,
                        point ? kCausticKnown : LightKinds{}, 0, bright_ ? 1.0f : 0.0f});
  return irradiance;
}

/// The share that the ray contributes of the light at its hit. `point` represents the hit; 1 if it is nullptr.
inline float IncomingRadiance::remaining_share(const Met& met, const PointLookup::Light* point,
                                               const Further& from) const {
  return from.sampled_lobe > 0 && point ? bright_->remaining_share(*point, met.leg * from.sampled_lobe) : 1.0f;
}

/// Direct irradiance [W/m^2] at a hit, from one sample of the directional lights, if there are any, and one sample of
/// all other lights. If one sample chose among all lights, few samples in a room would choose its window or its lamps,
/// because the choice does not know that the sun is blocked. `point` represents the hit, or is nullptr. sampled_lobe:
/// Further::sampled_lobe, which decides whether light of close lamps is left out (BrightPoints::has_lamp_light).
Rgb IncomingRadiance::sampled_light(const Met& met, const SeenSide& side, const PointLookup::Light* point,
                                    float sampled_lobe, const PathRandom& random, GatherCounts& counts) const {
  const Receiver at{met.hit, side.normal_geometric, side.normal, met.bsdf->has_specular() ? met.bsdf : nullptr};
  Rgb sum{0.0f};
  const auto add = [&](const DirectSample& direct) {
    if (sampled_lobe > 0 && !direct.light.distant &&
        bright_->has_lamp_light(point, met.leg * sampled_lobe, length(direct.light.position - met.hit.position)))
      return;
    ++counts.shadow_rays;
    sum += direct.irradiance * transmittance(tracer_, direct.shadow, {random, 1, way_shadow});
  };
  if (lights_.empty()) return sum;
  DirectSample direct;
  const Vec2 u = random.get2(1, Purpose::light_point);
  if (!lights_.has_suns()) {
    if (sample_direct(lights_, at, random.get1(1, Purpose::light_choice), u, direct)) add(direct);
    return sum;
  }
  if (sample_sun(lights_, at, random.get2(1, Purpose::sun), direct)) add(direct);
  if (sample_other_than_suns(lights_, at, u, direct)) add(direct);
  return sum;
}

}  // namespace tempolux
