// lib/material/opaque_lobes.h -- lobes that reflect: Lambert, and the mirror and GGX with the functions of lobe.h.
#pragma once

#include "lib/core/sampling.h"
#include "lib/material/albedo.h"
#include "lib/material/anisotropic_ggx.h"
#include "lib/material/ggx.h"
#include "lib/material/lobe.h"

namespace tempolux {

/// f = rho / pi  c(wo) c(wi), the lobe of event D.
class Lambert {
 public:
  void add(Rgb rho) { rho_ += rho; }
  Rgb rho() const { return rho_; }
  Rgb eval(float coupling_i, float coupling_o, float share) const {
    return rho_ * (kInvPi * coupling_i * coupling_o * share);
  }
  float pdf_solid_angle(Vec3 wi) const { return pdf_hemisphere_cos(wi.z); }

 private:
  Rgb rho_{0.0f};
};

/// The share (1 - cos_h)^5 [1] of F90 - F0 that Schlick's Fresnel term adds to F0.
inline float schlick_rise(float cos_h) {
  const float x = std::clamp(1 - cos_h, 0.0f, 1.0f);
  return x * x * x * x * x;
}

/// Schlick's Fresnel term, F0 + (F90 - F0) (1 - cos_h)^5 [1]. Schlick, "An Inexpensive BRDF Model for
/// Physically-based Rendering", CGF 13(3), 1994.
struct Schlick {
  Rgb f0{0.0f};
  float f90 = 0;
  Rgb at(float cos_h) const;
  Rgb mean() const;  ///< cosine-weighted mean over the hemisphere: (20 F0 + F90) / 21
  float mean_of_largest() const { return max_component(mean()); }  ///< the same of the largest channel
  /// Share of uniform light [1] that microfacets of this width reflect towards w. e: their albedo for F0 and F90.
  template <class Width>
  Rgb albedo(const Width&, Vec3, AlbedoPair e) const {
    return f0 * e.a + Rgb(f90 * e.b);
  }
  /// Cosine-weighted mean of the albedo's largest channel [1]; e: mean of the microfacets' albedo.
  template <class Width>
  float mean_albedo(const Width&, AlbedoPair e) const {
    return max_component(f0) * e.a + f90 * e.b;
  }
};

/// Schlick's Fresnel term of a surface that is a dielectric in one part and a metal in the other. F0 and F90 are the
/// means of both. Only the dielectric lies above the Lambert lobe; the metal lies beside this lobe (glTF 2.0, appendix
/// B).
struct PartMetal : Schlick {
  Schlick dielectric, metal;
  float metallic;  ///< share of the metal [1]
  PartMetal(const Schlick& d, const Schlick& m, float share)
      : Schlick{d.f0 * (1 - share) + m.f0 * share, d.f90 * (1 - share) + m.f90 * share},
        dielectric(d),
        metal(m),
        metallic(share) {}
};

/// Reflects F(cos) of the light from one direction into one other.
/// Fresnel is Schlick or has its functions (ThinFilm).
template <class Fresnel>
class BasicMirror {
 public:
  static constexpr bool kDelta = true;

  explicit BasicMirror(const Fresnel& fresnel) : fresnel_(fresnel) {}
  float mean_kept() const;
  LobeAlbedo albedo(Vec3 w) const;
  Rgb eval(LobeDirection, LobeDirection) const { return Rgb(0.0f); }
  float pdf_solid_angle(Vec3, LobeDirection) const { return 0; }
  void sample(LobeDirection wo, float u_lobe, Vec2 u, LobeSample& s) const;
  Rgb weight(LobeDirection wi, LobeDirection wo, float chance, float pdf) const;

 private:
  Fresnel fresnel_;
};
using Mirror = BasicMirror<Schlick>;

/// GGX of equal width all round (ggx.h).
class RoundGgx {
 public:
  static constexpr bool kDirected = false;

  explicit RoundGgx(float alpha) : alpha_(alpha), alpha2_(alpha * alpha), albedo_(alpha) {}
  AlbedoPair albedo(Vec3 w) const { return albedo_.at(w.z); }
  AlbedoPair mean_albedo() const { return albedo_.mean(); }
  float reflection(Vec3 wi, Vec3 wo, Vec3 h) const {
    return ggx::distribution(h, alpha2_) * ggx::visibility(wi.z, wo.z, alpha2_);
  }
  Vec3 sample_normal(Vec3 wo, Vec2 u) const { return ggx::sample_visible_normal(wo, alpha_, alpha_, u); }
  float pdf_reflected(Vec3 h, Vec3 wo) const { return ggx::pdf_reflected(h, wo.z, alpha2_); }

 private:
  float alpha_, alpha2_;
  GgxAlbedo albedo_;
};

/// GGX (ggx.h) with Schlick's Fresnel term F at wo h. GGX alone loses the light that microfacets reflect more than once
/// (70 % for a rough white metal at normal incidence). It is added as by Kulla & Conty, "Revisiting Physically Based
/// Shading at Imageworks", 2017:
///     f_ms(wi, wo) = F_ms (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_mean)),
///     F_ms = F_mean^2 E_mean / (1 - F_mean (1 - E_mean)),   F_mean = (20 F0 + F90) / 21,
/// where E is the albedo of GGX for F = 1. f_ms is reciprocal, and for F = 1 all light is reflected. The directional
/// albedo A(w) is F0 a + F90 b + F_ms (1 - E) with a + b = E; a and b come from a table. f_ms is faded in between the
/// roughnesses 0.23 and 0.34, where GGX loses 1 and 3 % on average. Below them grazing light loses up to 11 %.
///
/// Width says how wide GGX is: RoundGgx or AnisotropicGgx (anisotropic_ggx.h). Fresnel is Schlick, PartMetal, or has
/// the functions of Schlick.
template <class Width, class Fresnel = Schlick>
class BasicGloss {
 public:
  static constexpr bool kDelta = false;

  BasicGloss(const Fresnel& fresnel, const Width& width, float share);
  float mean_kept() const { return mean_kept_; }
  LobeAlbedo albedo(Vec3 w) const;
  Rgb eval(LobeDirection wi, LobeDirection wo) const;
  float pdf_solid_angle(Vec3 wi, LobeDirection wo) const;
  void sample(LobeDirection wo, float u_lobe, Vec2 u, LobeSample& s) const;
  Rgb weight(LobeDirection wi, LobeDirection wo, float chance, float pdf) const;

  /// Expresses the width's axes in another local frame.
  void turn(const Frame& from, const Frame& to) requires Width::kDirected { width_.turn(from, to); }

 private:
  Rgb f(LobeDirection wi, LobeDirection wo) const;

  Fresnel fresnel_;
  float share_;
  Width width_;
  Rgb multiple_{0.0f};  ///< F_ms / (1 - E_mean), faded in
  float mean_lost_;     ///< 1 - E_mean
  float mean_kept_;
  float kept_multiple_ = 0;  ///< multiple_ of PartMetal's dielectric
};
using Gloss = BasicGloss<RoundGgx>;
using AnisotropicGloss = BasicGloss<AnisotropicGgx>;

}  // namespace tempolux
