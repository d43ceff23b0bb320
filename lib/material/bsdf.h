// lib/material/bsdf.h -- scattering at a surface: a Lambert lobe (event D) and other lobes (event S).
#pragma once

#include <optional>

#include "lib/core/sampling.h"
#include "lib/core/vec.h"
#include "lib/material/albedo.h"
#include "lib/material/rough_glass.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// Scattering of one material at one point, in the local frame of the shading normal (z = normal).
///
/// f = f_D + f_S [1/sr]. wi and wo are unit vectors away from the surface, both on the side z > 0, else f = 0. Two
/// exceptions: rough glass also scatters to wi.z < 0, and delta lobes can only be sampled.
///
/// f_S is GGX (ggx.h) with Schlick's Fresnel term F = F0 + (F90 - F0) (1 - wo h)^5, or below a roughness of
/// kMirrorRoughness a delta mirror with the same F. From glTF 2.0 and KHR_materials_specular, _ior:
///     F0  = mix(specular min(1, ((ior - 1) / (ior + 1))^2 specular_color), base_color, metallic)
///     F90 = mix(specular, 1, metallic)
/// GGX alone loses the light that microfacets reflect more than once (70 % for a rough white metal at normal
/// incidence). It is added as by Kulla & Conty, "Revisiting Physically Based Shading at Imageworks", 2017:
///     f_ms(wi, wo) = F_ms (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_mean)),
///     F_ms = F_mean^2 E_mean / (1 - F_mean (1 - E_mean)),   F_mean = (20 F0 + F90) / 21,
/// where E is the albedo of GGX for F = 1. f_ms is reciprocal, and for F = 1 all light is reflected. The directional
/// albedo A(w) of f_S is F0 a + F90 b + F_ms (1 - E) with a + b = E; a and b come from a table. f_ms is faded in
/// between the roughnesses 0.23 and 0.34, where GGX loses 1 and 3 % on average. At smaller roughness grazing light
/// loses up to 11 %.
///
/// f_D is the Lambert lobe rho / pi with rho = base_color (1 - metallic), under the reflection above it, coupled as by
/// Kelemen & Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", EG 2001:
///     f_D(wi, wo) = rho/pi  c(wo) c(wi),   c(w) = (1 - A(w)) / sqrt(1 - A_mean),
/// with A of the channel with the largest F0 and A_mean = 2 integral_0^1 A(mu) mu dmu. Then
///     integral of c(w) cos / pi = (1 - A_mean) / sqrt(1 - A_mean) = sqrt(1 - A_mean), and
///     integral of f_D(wi, wo) cos_i = rho c(wo) sqrt(1 - A_mean) = rho (1 - A(wo)):
/// the Lambert lobe receives the light that f_S does not reflect, and D and S together return A + rho (1 - A) <= 1 in
/// either direction. A matte material (F0 = F90 = 0) has no f_S, and c is exactly 1.
///
/// Glass (KHR_materials_transmission) replaces the share transmission (1 - metallic) of all this by a boundary that
/// reflects by the exact Fresnel equations and transmits the remaining light, tinted by base_color at each boundary.
/// Light is refracted at a solid (index ior inside) and goes straight through a thin wall. The boundary is smooth below
/// kMirrorRoughness, else rough_glass.h describes it. Paths carry L / n^2 in place of radiance L inside a solid of
/// index n, so a Lambert lobe inside a solid returns the same value as one outside. sample() also serves photons, which
/// carry watts; photon_trace.h divides their density inside a solid by n^2.
class Bsdf {
 public:
  /// material: values at the hit (scene.h lists their ranges). front: true if wo is on the triangle's front side,
  /// which is outside a solid of glass. An unlit material scatters nothing.
  explicit Bsdf(const MaterialValues& material, bool front = true);

  /// True if the material has a Lambert lobe, which may be black: points store the light that arrives at a black lobe,
  /// too.
  bool has_lambert() const { return lambert_; }
  bool has_diffuse() const { return diffuse_; }                         ///< true if the Lambert lobe reflects any light
  bool has_specular() const { return specular_ || transmission_ > 0; }  ///< true if there is an S lobe
  /// True if all S lobes are mirrors or smooth glass, or there is none.
  bool specular_is_delta() const { return !rough_ && (delta_ || !specular_); }
  /// The share of light samples that a caller should draw on the side z < 0, from where eval_specular() transmits
  /// light. Inside a solid of rough glass the share is 1, because lights are outside. Outside a solid it is 0, because
  /// a straight line into the solid meets the solid's other side before it reaches a light. For a thin wall it is 1/2.
  float light_share_behind() const { return light_share_behind_; }
  /// Reflectance rho of the Lambert lobe, without coupling. [1]
  Rgb diffuse_albedo() const { return rho_; }
  /// Share of light [1] that goes straight through a smooth thin wall (a pane): transmission (1 - F(cos_o)) base_color.
  /// sample() draws this passage, too. Black for other materials, and for cos_o <= 0.
  Rgb passed_straight(float cos_o) const;
  /// c(w) of the head of this class [1]; 1 for a matte material; cos_theta > 0.
  float diffuse_coupling(float cos_theta) const;
  /// A_S(wo) [1]: the share of uniform light that the S lobes reflect towards wo, from the albedo table; 0 for a
  /// matte material. Glass is not included.
  Rgb specular_albedo(float cos_o) const;
  /// The share of uniform light that the Lambert lobe reflects towards wo [1]: (1 - transmission) rho (1 - A_S(wo)).
  Rgb diffuse_reflectance(float cos_o) const;
  /// Weight [1] of light from wi in an irradiance E: (1 - A_S(wi)) / (1 - A_S,mean), 1 for a matte material. With
  /// this weight diffuse_reflectance(cos_o) E / pi is exactly the radiance that f_D reflects.
  float arrival_weight(float cos_i) const;

  /// A direction with the shares of uniform light that are reflected towards it. Looking up the shares is slow, so a
  /// caller that uses a direction several times calls along() once.
  struct Direction {
    Vec3 w{};
    struct Reflection {
      Rgb single{0.0f}, multiple{0.0f};  ///< shares reflected by one and by several microfacets
      float lost = 0;                    ///< 1 - E: the share that GGX alone would lose at F = 1
    } reflected;                         ///< 0 below the surface
  };
  /// The Direction of w (unit, local frame).
  Direction along(Vec3 w) const { return {w, w.z > 0 ? reflection(w.z) : Reflection{}}; }

  /// f_D and f_S [1/sr], without the cosine; 0 for mirrors and smooth glass.
  Rgb eval_diffuse(const Direction& wi, const Direction& wo) const;
  Rgb eval_specular(const Direction& wi, const Direction& wo) const;
  Rgb eval_diffuse(Vec3 wi, Vec3 wo) const { return eval_diffuse(along(wi), along(wo)); }
  Rgb eval_specular(Vec3 wi, Vec3 wo) const { return eval_specular(along(wi), along(wo)); }

  struct Sample {
    Vec3 wi{};         ///< unit, away from the surface
    Rgb weight{0.0f};  ///< f cos / pdf of the drawn event alone, divided by the event's probability [1]
    float pdf_solid_angle =
        0;                     ///< pdf of wi over all non-delta lobes [1/sr]; if delta, the probability of the lobe [1]
    bool diffuse = false;      ///< event D, else S
    bool delta = false;        ///< mirror or smooth glass
    bool transmitted = false;  ///< wi is on the other side, z < 0
    bool straight = false;     ///< light passes a pane, wi = -wo, which is no event
  };
  /// Draws wi for wo: u_lobe chooses the lobe, u the direction; all numbers are in [0, 1). The weight is that of the
  /// chosen event alone, f_D cos / (P(D) pdf_D) or f_S cos / (P(S) pdf_S), so that callers can sort light by events.
  /// The weight is zero if wo is below the surface or nothing is reflected.
  Sample sample(const Direction& wo, float u_lobe, Vec2 u) const;
  Sample sample(Vec3 wo, float u_lobe, Vec2 u) const { return sample(along(wo), u_lobe, u); }
  /// True if the material is a reflecting Lambert lobe and nothing else. Then sample() equals sample_matte() with the
  /// direction sample_hemisphere_cos(u), which callers may draw for many hits at once.
  bool is_matte() const { return diffuse_ && !specular_ && !(transmission_ > 0); }
  Sample sample_matte(Vec3 wo, Vec3 cosine_direction) const {
    if (!(wo.z > 0)) return {};
    return {.wi = cosine_direction,
            .weight = rho_,
            .pdf_solid_angle = pdf_hemisphere_cos(cosine_direction.z),
            .diffuse = true};
  }
  /// pdf [1/sr] with which sample() draws wi by event D, and by event S, including the probability of the event.
  /// Mirrors and smooth glass count as 0.
  float pdf_diffuse(Vec3 wi, const Direction& wo) const;
  float pdf_specular(Vec3 wi, const Direction& wo) const;
  float pdf_diffuse(Vec3 wi, Vec3 wo) const { return pdf_diffuse(wi, along(wo)); }
  float pdf_specular(Vec3 wi, Vec3 wo) const { return pdf_specular(wi, along(wo)); }
  /// pdf [1/sr] of wi under the condition that event S is drawn; infinite for mirrors and for all materials with
  /// glass.
  float gloss_density(Vec3 wi, const Direction& wo) const;
  /// True if the lobes can be sampled separately: a Lambert lobe under a reflection, or the reflection and the
  /// transmission of smooth glass and nothing else.
  bool forks() const { return transmission_ > 0 ? transmission_ == 1 && !rough_ : diffuse_ && specular_; }
  /// If forks(): sample() draws the Lambert lobe, or the reflection of glass, for u_lobe below this probability, else
  /// the other lobe. wo is above the surface.
  float fork_probability(const Direction& wo) const;
  /// True if sample() draws event D for this u_lobe, whatever its other random numbers are.
  bool draws_diffuse(const Direction& wo, float u_lobe) const;

 private:
  using Reflection = Direction::Reflection;
  Reflection reflection(float cos_theta) const;
  float coupling(const Reflection& r) const;
  float diffuse_probability(const Reflection& r) const;
  static float multiple_share(const Reflection& r);
  Rgb specular(Vec3 wi, Vec3 wo, float lost_i, float lost_o) const;
  float pdf_given_specular(Vec3 wi, Vec3 wo, const Reflection& r) const;
  void sample_dielectric(Vec3 wo, float u_lobe, Sample& s) const;
  void sample_rough(const Direction& wo, float u_lobe, Vec2 u, Sample& s) const;
  Rgb eval_opaque(const Direction& wi, const Direction& wo) const;
  Rgb eval_rough(Vec3 wi, Vec3 wo) const;
  Sample sample_opaque(const Direction& wo, float u_lobe, Vec2 u) const;
  void sample_diffuse(Vec3 wo, Vec2 u, const Reflection& r, Sample& s) const;
  void sample_specular(Vec3 wo, float u_lobe, Vec2 u, const Reflection& r, Sample& s) const;

  Rgb rho_{0.0f}, f0_{0.0f};
  Rgb multiple_{0.0f};  ///< F_ms / (1 - E_mean), faded in (head of this class)
  float f0_max_ = 0, f90_ = 0;
  float alpha_ = 1, alpha2_ = 1;
  GgxAlbedo albedo_;
  float mean_lost_ = 0;       ///< 1 - E_mean
  float mean_albedo_ = 0;     ///< A_mean of the channel with the largest F0
  float coupling_scale_ = 1;  ///< 1 / sqrt(1 - A_mean)
  Rgb transmission_tint_{0.0f};
  float transmission_ = 0;   ///< share of glass, whose scattering is event S; f_D and f_S have the remaining share
  float eta_ = 1;            ///< for refraction: index on wo's side / index on the other side; 1 for a thin wall
  float eta_reflected_ = 1;  ///< for the Fresnel term: the same quotient, also for a thin wall
  float light_share_behind_ = 0;
  bool pane_ = false;                ///< the wall is thin and smooth
  std::optional<RoughGlass> rough_;  ///< empty: the glass is smooth, or there is none
  bool lambert_ = false, diffuse_ = false, specular_ = false, delta_ = false;
};

}  // namespace tempolux
