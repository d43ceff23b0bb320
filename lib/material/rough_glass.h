// lib/material/rough_glass.h -- a rough boundary of glass: GGX microfacets that reflect and transmit.
#pragma once

#include "lib/core/vec.h"
#include "lib/material/albedo.h"
#include "lib/material/glass_albedo.h"

namespace tempolux {

/// Both lobes of a rough dielectric in the local frame; wo is on the side z > 0, wi above (reflected) or below
/// (transmitted).
///
/// Solid: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, (20) and (21), with
/// Smith's height-correlated masking G = 1 / (1 + L(wi) + L(wo)) on both sides and the exact Fresnel term F:
///     f_r = F D(h) G / (4 cos_i cos_o),                                    h = normalize(wi + wo)
///     f_t = (1 - F) D(h) G |wi h| |wo h| / (cos_i cos_o (wi h + eta wo h)^2),  h = +-normalize(wi + eta wo)
/// eta = (index on wo's side) / (index on the other side). f_t applies to radiance that is not scaled by the squared
/// index inside (bsdf.h): it is Walter's f_t times (index of wi / index of wo)^2. Then n_o^2 f_t(wi, wo) = n_i^2
/// f_t(wo, wi), and a photon, which carries watts, is scattered by the same f with its own direction as wo, without a
/// further factor. Thin wall, as in KHR_materials_transmission: f_t = (1 - F) x the reflected lobe without F, mirrored
/// at the surface, so that light goes straighter through a smoother wall.
///
/// Light that meets several microfacets, 1 - E, is distributed over both sides as by Kulla & Conty (2017):
///     f_ms(wi, wo) = share (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_mean(side of wi))).
/// The share of the other side is b if seen from outside and d if seen from inside. Reciprocity requires
///     b / d = n^2 (1 - E_mean,in) / (1 - E_mean,out).
/// b = 1 - F_mean as long as d is below 1. The rest is reflected. No light is lost.
class RoughGlass {
 public:
  /// index >= 1: of the solid. alpha in (0, 1]: of GGX. outside: true if wo is outside the solid; without effect for
  /// a thin wall.
  RoughGlass(float index, float alpha, bool thin, bool outside);

  float eval(Vec3 wi, Vec3 wo) const;  ///< f [1/sr], without a tint
  float pdf(Vec3 wi, Vec3 wo) const;   ///< pdf with which sample() draws wi [1/sr]
  /// Draws a direction wi above or below the surface; all numbers are in [0, 1). The weight of the sample is eval
  /// |cos_i| / pdf. A result with wi.z = 0 is a lost sample: a microfacet has sent light to the wrong side of the
  /// surface.
  Vec3 sample(Vec3 wo, float u_lobe, Vec2 u) const;

 private:
  struct Pair {  ///< for a pair of directions: f of single scattering [1/sr], and the pdf with which sample() draws it
                 ///< [1/sr]
    float f = 0, pdf = 0;
  };
  Pair single(Vec3 wi, Vec3 wo) const;
  float loss(bool behind, float cos_theta) const;
  float mean_loss(bool behind) const;
  float multiple_pdf(float cos_i) const;

  GlassLoss loss_;  ///< for a solid
  GgxAlbedo wall_;  ///< for a thin wall: the albedo of a mirror
  float alpha_, alpha2_;
  float eta_;  ///< index on wo's side / index on the other side, for the Fresnel term
  bool thin_;
  int side_;                    ///< side of wo: 0 outside, 1 inside
  float share_behind_;          ///< share of f_ms on the other side
  float spread2_, log_spread_;  ///< spread^2 and log(1 + 1 / spread^2) of multiple_pdf()
};

}  // namespace tempolux
