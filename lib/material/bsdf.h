// lib/material/bsdf.h -- scattering at a surface: a Lambert lobe (event D) and other lobes (event S).
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "lib/core/sampling.h"
#include "lib/material/coat.h"
#include "lib/material/dielectric_lobe.h"
#include "lib/material/opaque_lobes.h"
#include "lib/material/sheen.h"
#include "lib/material/thin_film.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// Scattering of one material at one point, in the local frame of the shading normal (z = normal).
///
/// f = f_D + f_S [1/sr]. wi and wo are unit vectors away from the surface, both on the side z > 0, else f = 0. Two
/// exceptions: rough glass also scatters to wi.z < 0, and delta lobes can only be sampled.
///
/// The lobes lie in a stack: those of event S, below them the Lambert lobe of event D. Each receives the light that the
/// lobes above it do not reflect. The coupling of the Lambert lobe follows Kelemen & Szirmay-Kalos, "A Microfacet Based
/// Coupled Specular-Matte BRDF Model", EG 2001. If a lobe of albedo A lies above the Lambert lobe, the value of the
/// Lambert lobe is multiplied by
///     c(wo) c(wi),   c(w) = (1 - A(w)) / sqrt(1 - A_mean).
/// A is the albedo of the largest channel, and A_mean its cosine-weighted mean over the hemisphere. If a
/// surface is metal in part, A is the albedo of the dielectric alone, because the metal lies beside the Lambert lobe.
/// With several lobes above, c(w) is the product of their factors, and
///     f_D(wi, wo) = rho/pi  c(wo) c(wi).
/// c(wi) does not depend on wo, and c(wo) does not depend on wi. So records, points and photons can store light that is
/// already multiplied by c(wi), and a reader multiplies it by c(wo) for its own direction. This is exact for every wo,
/// also below a coat or a sheen. Below a single lobe
///     integral of c(w) cos / pi = (1 - A_mean) / sqrt(1 - A_mean) = sqrt(1 - A_mean), and
///     integral of f_D(wi, wo) cos_i = rho c(wo) sqrt(1 - A_mean) = rho (1 - A(wo)):
/// the Lambert lobe receives the light that f_S does not reflect, and D and S together return A + rho (1 - A) <= 1 in
/// either direction.
///
/// The material of glTF 2.0 is a Lambert lobe with rho = base_color (1 - metallic) under a Gloss, or below a roughness
/// of kMirrorRoughness under a Mirror (opaque_lobes.h), with
///     F0  = mix(specular min(1, ((ior - 1) / (ior + 1))^2 specular_color), base_color, metallic)
///     F90 = mix(specular, 1, metallic).
/// If metallic lies between 0 and 1, the material is the mixture of a dielectric and a metal with these shares
/// (PartMetal).
/// A matte material (F0 = F90 = 0) has no f_S, and c is exactly 1. KHR_materials_clearcoat adds a Gloss or a Mirror
/// above these, with F0 = 0.04 clearcoat and F90 = clearcoat. A coat with a normal of its own is a Coat (coat.h).
/// Between the two lies the sheen of KHR_materials_sheen (sheen.h). KHR_materials_anisotropy makes the Gloss wider
/// along one direction (anisotropic_ggx.h). KHR_materials_iridescence replaces Schlick's Fresnel term of the Gloss or
/// the Mirror by that of a thin film (thin_film.h).
///
/// Glass (dielectric_lobe.h) replaces the share transmission (1 - metallic) of all this, clearcoat and sheen included.
/// Smooth glass keeps the thin film.
/// Paths carry L / n^2 in place of radiance L inside a solid of index n, so a Lambert lobe inside a solid returns the
/// same value as one outside. sample() also serves photons, which carry watts; photon_trace.h divides their density
/// inside a solid by n^2.
///
/// The Lambert lobe's factor c(wo) c(wi) would make a mirror below a coat return more light than arrives, since a
/// mirror does not spread light over the hemisphere. A lobe of event S below others is multiplied by min(P(wi), P(wo)),
/// where P(w) is the product of 1 - A(w) over the lobes above it. This is exact for mirrors. A wide lobe loses light
/// that leaves at a more grazing angle than it arrived: the coat would have sent part of this light back to the lobe.
/// The loss is at most 5 % below a smooth coat of index 1.5.
///
/// KHR_materials_diffuse_transmission adds a Lambert lobe that sends light to the other side. It is a Bsdf of its own,
/// for which MaterialValues::from_far_side is set (diffuse_transmission.h): the stack weighs light by c and reflects
/// none.
///
/// A further lobe of event S is a class with the functions that lobe.h lists, in a file of its own. Its name stands in
/// Layer, and the constructor adds it. A further lobe of event D adds its rho to that of the Lambert lobe.
class Bsdf {
 public:
  static constexpr int kMostLobes = 6;  ///< glass, Lambert and those of the stack

  /// material: values at the hit (scene.h lists their ranges). front: true if wo is on the triangle's front side,
  /// which is outside a solid of glass. An unlit material scatters nothing. plate [m]: SurfacePoint::plate.
  explicit Bsdf(const MaterialValues& material, bool front = true, float plate = 0)
      : Bsdf(material, front, nullptr, Carries::radiance, plate) {}
  /// The same, for a material with axes (SurfaceAxes). frame: the local frame, whose z axis is the shading normal on
  /// the side of wo. carries: what the path carries; Carries::flux if wo leads to the light.
  Bsdf(const MaterialValues& material, bool front, const Frame& frame, Carries carries = Carries::radiance,
       float plate = 0)
      : Bsdf(material, front, &frame, carries, plate) {}

  /// use(bsdf) of the same scattering in another local frame. Only a Bsdf whose lobes have axes is copied.
  template <class Use>
  auto in_frame(const Frame& from, const Frame& to, const Use& use) const {
    return directed_ ? use(turned(from, to)) : use(*this);
  }

  /// True if the material has a Lambert lobe, which may be black: points store the light that arrives at a black lobe,
  /// too.
  bool has_lambert() const { return has_lambert_; }
  /// True if the Lambert lobe reflects any light, or if the material transmits diffusely: then also where the lobe of
  /// this side is black.
  bool has_diffuse() const { return diffuse_; }
  /// True if there is an S lobe. On a far side the lobe weighs light and scatters none.
  bool has_specular() const { return lobes_ > 0 || glass_; }
  /// True if all S lobes are mirrors or smooth glass, or there is none.
  bool specular_is_delta() const { return spread_ == 0; }
  /// The share of light samples that a caller should draw on the side z < 0, from where eval_specular() transmits
  /// light. Inside a solid of rough glass the share is 1, because lights are outside. Outside a solid it is 0, because
  /// a straight line into the solid meets the solid's other side before it reaches a light. For a thin wall it is 1/2.
  float light_share_behind() const { return glass_ ? glass_->light_share_behind() : 0; }
  /// Reflectance rho of the Lambert lobe, without coupling. [1]
  Rgb diffuse_albedo() const { return lambert_.rho(); }
  /// Share of light [1] that goes straight through a smooth thin wall (a pane): transmission (1 - F(cos_o)) base_color.
  /// At a plate, the share at this side (DielectricLobe). sample() draws this passage, too. Black for other materials,
  /// and for cos_o <= 0.
  Rgb passed_straight(float cos_o) const { return glass_ && cos_o > 0 ? glass_->passed_straight(cos_o) : Rgb(0.0f); }
  /// c(w) of the head of this class [1]; 1 for a matte material; w.z > 0.
  float diffuse_coupling(Vec3 w) const;
  /// A_S(wo) [1]: the share of uniform light that the S lobes reflect towards wo, from the albedo table; 0 for a
  /// matte material. Glass is not included.
  Rgb specular_albedo(Vec3 wo) const;
  /// The share of uniform light that the Lambert lobe reflects towards wo [1]: (1 - transmission) rho (1 - A(wo)), A as
  /// in the head of this class.
  Rgb diffuse_reflectance(Vec3 wo) const;
  /// Weight [1] of light from wi in an irradiance E: (1 - A(wi)) / (1 - A_mean), 1 for a matte material. With
  /// this weight diffuse_reflectance(wo) E / pi is exactly the radiance that f_D reflects.
  float arrival_weight(Vec3 wi) const;
  /// The same for wi in scene space; normal: the z axis of the local frame.
  float arrival_weight(Vec3 wi, Vec3 normal) const {
    return arrival_weight(directed_ ? Frame(normal).to_local(wi) : Vec3{0, 0, dot(wi, normal)});
  }

  /// A direction with the shares of uniform light that the lobes of event S reflect towards it. Looking up the shares
  /// is slow, so a caller that uses a direction several times calls along() once.
  struct Direction {
    Vec3 w;
    float passed = 1;  ///< share of light that passes all lobes of the stack; 1 below the surface
    union {
      LobeAlbedo albedo[kMostLobes - 2];  ///< above the surface; set for the lobes that the stack has
    };
    Direction(Vec3 w_ = {}) : w(w_) {}
  };
  /// The Direction of w (unit, local frame).
  Direction along(Vec3 w) const {
    Direction d(w);
    if (lobes_ > 0 && w.z > 0) look_up(d);
    return d;
  }

  /// f_D and f_S [1/sr], without the cosine; 0 for mirrors and smooth glass.
  Rgb eval_diffuse(const Direction& wi, const Direction& wo) const;
  Rgb eval_specular(const Direction& wi, const Direction& wo) const;
  Rgb eval_diffuse(Vec3 wi, Vec3 wo) const { return eval_diffuse(along(wi), along(wo)); }
  Rgb eval_specular(Vec3 wi, Vec3 wo) const { return eval_specular(along(wi), along(wo)); }

  using Sample = LobeSample;
  /// Draws wi for wo: u_lobe chooses the lobe, u the direction; all numbers are in [0, 1). The weight is that of the
  /// chosen event alone, f_D cos / (P(D) pdf_D) or f_S cos / (P(S) pdf_S), so that callers can sort light by events.
  /// The weight is zero if wo is below the surface or nothing is reflected.
  Sample sample(const Direction& wo, float u_lobe, Vec2 u) const;
  Sample sample(Vec3 wo, float u_lobe, Vec2 u) const { return sample(along(wo), u_lobe, u); }
  /// True if the material is a reflecting Lambert lobe and nothing else. Then sample() equals sample_matte() with the
  /// direction sample_hemisphere_cos(u), which callers may draw for many hits at once.
  bool is_matte() const { return lobes_ == 0 && !glass_ && has_diffuse(); }
  Sample sample_matte(Vec3 wo, Vec3 cosine_direction) const {
    if (!(wo.z > 0)) return {};
    return {.wi = cosine_direction,
            .weight = lambert_.rho(),
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
  bool forks() const {
    return glass_ ? glass_->share() == 1 && glass_->is_delta() && glass_->reflects()
                  : has_diffuse() && lobes_ > 0 && !far_side_;
  }
  /// If forks(): sample() draws the Lambert lobe, or the reflection of glass, for u_lobe below this probability, else
  /// the other lobe. wo is above the surface.
  float fork_probability(const Direction& wo) const;
  /// True if sample() draws event D for this u_lobe, whatever its other random numbers are.
  bool draws_diffuse(const Direction& wo, float u_lobe) const;

 private:
  struct Layer {
    Layer() {}  ///< sets no byte of the lobe: the compiler would clear all of them for every hit
    std::variant<std::monostate, Mirror, Gloss, AnisotropicGloss, Sheen, Coat<Mirror>, Coat<Gloss>,
                 BasicMirror<PartMetal>, BasicGloss<RoundGgx, PartMetal>, BasicGloss<AnisotropicGgx, PartMetal>,
                 BasicMirror<ThinFilm>, BasicGloss<RoundGgx, ThinFilm>, BasicGloss<AnisotropicGgx, ThinFilm>>
        lobe;
  };

  Bsdf(const MaterialValues& material, bool front, const Frame* frame, Carries carries, float plate);
  template <class AnyLobe, class... Parameters>
  void add(const Parameters&... parameters);
  Bsdf turned(const Frame& from, const Frame& to) const;
  template <class Fresnel>
  void add_round(const Fresnel& fresnel, float roughness);
  void add_coat(const MaterialValues& material, const Frame* frame, Carries carries);
  void add_reflection(const MaterialValues& material, const Schlick& fresnel, const Frame* frame);
  template <class Fresnel>
  void add_directed(const MaterialValues& material, const Fresnel& fresnel, const Frame* frame);
  template <class Function>
  auto visit(int i, Function&& function) const;
  void look_up(Direction& d) const;
  LobeDirection seen(const Direction& d, int i) const { return {d.w, d.albedo[i]}; }
  Rgb reflected(int i, const Direction& d) const;
  float coupling(const Direction& d) const { return d.passed * coupling_scale_; }
  float diffuse_probability(const Direction& wo) const;
  float pdf_given_specular(Vec3 wi, const Direction& wo) const;
  /// u_lobe, stretched from [share of glass, 1) to [0, 1).
  float stretched(float u_lobe) const { return std::min(kOneMinusEpsilon, (u_lobe - glass_->share()) / rest_); }
  int choose(const Direction& wo, float& u_lobe, float& chance) const;
  void sample_diffuse(const Direction& wo, Vec2 u, float p, Sample& s) const;
  void sample_specular(const Direction& wo, float u_lobe, Vec2 u, float p, Sample& s) const;
  void sample_stack(const Direction& wo, float u_lobe, Vec2 u, Sample& s) const;
  void weigh_by_all(const Direction& wo, Sample& s) const;

  std::array<Layer, kMostLobes - 2> stack_;  ///< lobes of event S from the top down; the Lambert lobe is below them
  int lobes_ = 0;                            ///< number of lobes in the stack
  int spread_ = 0;                           ///< number of lobes of event S that are not delta, rough glass included
  Lambert lambert_;
  float coupling_scale_ = 1;  ///< of the Lambert lobe: 1 / sqrt(1 - A_mean), multiplied over the stack
  float rest_ = 1;            ///< share of the stack and the Lambert lobe: 1 - transmission (1 - metallic)
  bool has_lambert_ = false, diffuse_ = false;
  bool lit_ = true;        ///< false: the stack reflects all light
  bool far_side_ = false;  ///< MaterialValues::from_far_side: the stack weighs light and reflects none
  bool directed_ = false;  ///< true if lobes of the stack have axes of their own
  std::optional<DielectricLobe> glass_;
};

}  // namespace tempolux
