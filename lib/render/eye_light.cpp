// lib/render/eye_light.cpp -- the light of a surface that a camera path has reached: what records, points and photons
// hold, and samples of lights.
#include "lib/core/sampling.h"
#include "lib/render/eye_tracer.h"
#include "lib/render/stored_places.h"

namespace tempolux {
namespace {

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

}  // namespace

/// Adds the light that records, points and photons hold for a surface, and notes in `at` which light was added. smooth:
/// the shading normal without a normal map.
void EyeTracer::add_known_light(EyeVertex& at, Vec3 smooth, const EyeState& state) const {
  const KnownLight& known = *known_;
  const ShadingPoint& x = at.x;
  const EyePath& path = state.path;
  Layers& result = *state.result;
  const StoredAt stored_at(scene_, x);
  const float u = state.random.get1(state.bounce, Purpose::gather);
  if (state.known.has(LightKind::bright) && !state.specular && !at.far_side)
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

/// Takes one sample of the suns (of_sun) or of the other lights, and adds what each lobe scatters, weighed by MIS
/// [Veach 1997 (9.14)], to the layer of the lobe.
void EyeTracer::sample_light(const EyeVertex& at, const EyeState& state, const PixelRandom& random, bool of_sun,
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
  if (behind && at.hero) [[unlikely]]
    glossy *= at.hero->color;
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

/// Decides for which lobes of a surface light of spots is sampled (EyeVertex::spots). The known light has the spots of
/// the frame's time. At another moment of the shutter spots lie elsewhere, so gloss samples none.
void EyeTracer::choose_spots(EyeVertex& at, const EyeState& state) const {
  if (!known_ || (!known_->lamp_spots && !known_->gloss_spots)) return;
  at.spots = at.known.has(LightKind::indirect) && !at.known.has(LightKind::lamps);
  const bool gloss = !scene_.stored && !state.inside.any();
  at.spots_of_gloss = gloss && at.known.has(LightKind::indirect) && !at.known.has(LightKind::direct) &&
                      !at.known.has(LightKind::caustic);
  at.spots_in_gloss = gloss && state.path.sharp() && samples_specular(at, state);
}

/// Takes one sample of the light of spots. Adds the light that records leave out, if `spots` are
/// KnownLight::lamp_spots, and the light that lobes S of the spot or of this surface reflect.
void EyeTracer::sample_spots(const BrightPoints& spots, const EyeVertex& at, const EyeState& state,
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
void EyeTracer::add_light(const EyeVertex& at, const EyeState& state) const {
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

}  // namespace tempolux
