// lib/render/eye_tracer.h -- the parts of the path tracer: a path, a surface that it has reached, and what happens
// there. path_tracer.cpp follows the path, eye_light.cpp adds the light of a surface.
#pragma once

#include "lib/material/dispersion.h"
#include "lib/material/inside.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "lib/transport/emission.h"
#include "lib/transport/light_kinds.h"
#include "lib/transport/media.h"
#include "lib/transport/specular_chain.h"

namespace tempolux {

/// A path between two vertices: its ray, its events so far, and which light was added already. Here an event D is
/// scattering by a Lambert lobe or in a medium.
struct EyeState {
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
struct EyeVertex {
  const ShadingPoint& x;
  const SurfaceMaterial& material;
  /// The wavelength that the path takes if the surface refracts it; null: the surface has no dispersion, or the path
  /// has its wavelength already.
  const HeroWavelength* hero = nullptr;
  LightKinds known{};         ///< light that was added
  float remaining_share = 1;  ///< share of the Lambert lobe's light that was not sampled explicitly at the last vertex
  bool forks = false;         ///< both lobes are followed
  /// True if the path goes on from the far side of a surface that transmits diffusely. Bright points and spots light
  /// lobes that reflect; light that is transmitted is not divided.
  bool far_side = false;
  /// Length [m] of the leg to this vertex times EyeState::divided. If it is above 0, the light of lamps close to this
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

/// Follows a camera path from its first hit to its end, with the forks of the path, and adds the light that it finds to
/// the parts of a sample.
class EyeTracer {
 public:
  EyeTracer(const RenderScene& scene, const KnownLight* known, const PathEffort& effort, RayCounts& counts,
            PathParts& parts)
      : scene_(scene), known_(known), effort_(effort), counts_(counts), parts_(parts) {}
  /// Follows the path of `state` to its end.
  void follow(EyeState state) const;

 private:
  enum class Passed { through, scattered, ended };
  Passed pass_media(const Media& media, EyeState& state) const;
  bool scatter_in_medium(const MediumPoint& point, EyeState& state) const;
  bool scatter(const EyeVertex& at, float u_lobe, float times, EyeState& state) const;
  inline bool survives(EyeState& state, float most) const;
  /// Sets the state after an event D.
  static void begin_matte(LightKinds known, EyeState& state) {
    state.matte = true, state.specular = false, state.refracted = false, state.known = known;
    state.distance = 0, state.spread = 1;
  }
  inline void go_on(const Ray& ray, EyeState& state) const;
  inline ShadingPoint shade(const SurfacePoint& point, const MaterialValues& material, EyeState& state,
                            bool& far_side) const;
  bool samples_diffuse(const EyeVertex& at) const {
    return !at.known.has(LightKind::direct) && at.x.bsdf.has_diffuse();
  }
  bool samples_specular(const EyeVertex& at, const EyeState& state) const {
    return !(state.matte && state.known.has(LightKind::caustic)) && at.x.bsdf.has_specular() &&
           !at.x.bsdf.specular_is_delta();
  }
  Lights::From sampled_lights() const { return scene_.suns_apart ? Lights::From::not_suns : Lights::From::all; }
  inline void sample_light(const EyeVertex& at, const EyeState& state, const PixelRandom& random, bool of_sun,
                           Layers& result) const;
  inline void sample_spots(const BrightPoints& spots, const EyeVertex& at, const EyeState& state,
                           const PixelRandom& random, Layers& result) const;
  void add_light(const EyeVertex& at, const EyeState& state) const;
  inline void add_met(Rgb light, const EyeState& state) const;
  inline void arrive(const SurfacePoint& point, EyeState& state) const;
  void add_known_light(EyeVertex& at, Vec3 smooth, const EyeState& state) const;
  inline bool leave(const EyeVertex& at, EyeState& state) const;
  inline bool step(EyeState& state) const;
  void choose_spots(EyeVertex& at, const EyeState& state) const;
  bool was_sampled(float divided_leg, Vec3 lamp, Vec3 position) const {
    return divided_leg > 0 && known_->samples_spot(divided_leg, length(lamp - position));
  }
  inline void go_onward(const EyeVertex& at, float u_lobe, float times, const EyeState& state) const;
  /// Adds `rays` to the counter `as`. If the path belongs to the part onward, also adds the rays' cost to
  /// counts_.onward.
  void count(std::uint64_t rays, std::uint64_t& as, const EyeState& state) const {
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

}  // namespace tempolux
