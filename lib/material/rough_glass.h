// lib/material/rough_glass.h -- a rough boundary of glass: GGX microfacets that reflect and let through.
#pragma once

#include "lib/core/vec.h"
#include "lib/material/albedo.h"
#include "lib/material/glass_albedo.h"

namespace tempolux {

/// Both lobes of a rough dielectric, local frame, wo on the side z > 0; wi above (reflected) or below.
///
/// Solid: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, (20) and (21),
/// with Smith's height-correlated masking G = 1 / (1 + L(wi) + L(wo)) on both sides and the exact Fresnel term F:
///     f_r = F D(h) G / (4 cos_i cos_o),                                    h = normalize(wi + wo)
///     f_t = (1 - F) D(h) G |wi h| |wo h| / (cos_i cos_o (wi h + eta wo h)^2),  h = +-normalize(wi + eta wo)
/// eta = (index on wo's side) / (index beyond). f_t is for radiance that is not scaled by the index squared inside
/// (bsdf.h): Walter's times (index of wi / index of wo)^2. With it n_o^2 f_t(wi, wo) = n_i^2 f_t(wo, wi), and
/// a photon, which carries watts, is scattered by the same f with its own direction for wo: no factor on either way.
/// Thin wall, as KHR_materials_transmission: f_t = (1 - F) x the reflected lobe without F mirrored at the
/// surface, so that a smoother wall lets through straighter.
///
/// Light that meets several microfacets, 1 - E, is spread as by Kulla & Conty (2017) over both sides:
///     f_ms(wi, wo) = share (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_mean(side of wi))),
/// share of the side beyond: b seen from outside, d from inside, b / d = n^2 (1 - E_mean,in) / (1 - E_mean,out)
/// for reciprocity, b = 1 - F_mean where d stays below 1; the rest is reflected. All light comes back.
class RoughGlass {
 public:
  /// index >= 1, of the solid; alpha of GGX in (0, 1]; outside: wo is outside the solid (no matter if thin).
  RoughGlass(float index, float alpha, bool thin, bool outside);

  float eval(Vec3 wi, Vec3 wo) const;  ///< f [1/sr], without a tint
  float pdf(Vec3 wi, Vec3 wo) const;   ///< of sample() [1/sr]
  /// A direction wi above or below; eval |cos| / pdf is its weight. Not unit or on no side: lost (rare).
  Vec3 sample(Vec3 wo, float u_lobe, Vec2 u) const;

 private:
  struct Pair {  ///< of directions: what one microfacet scatters, and the density of sample() that does
    float f = 0, pdf = 0;
  };
  Pair single(Vec3 wi, Vec3 wo) const;
  float loss(bool beyond, float cos_theta) const;
  float mean_loss(bool beyond) const;
  float multiple_density(float cos_i) const;

  GlassLoss loss_;  ///< of a solid
  GgxAlbedo wall_;  ///< of a thin wall: that of a mirror
  float alpha_, alpha2_;
  float eta_;  ///< index on wo's side / beyond, of the Fresnel term
  bool thin_;
  int side_;                    ///< of wo: 0 outside, 1 inside
  float share_beyond_;          ///< of f_ms
  float spread2_, log_spread_;  ///< of multiple_density
};

}  // namespace tempolux
