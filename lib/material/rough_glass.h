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
/// eta = (index on wo's side) / (index on the other side). f_t is Walter's f_t times (index of wi / index of wo)^2,
/// since paths carry L / n^2 inside a solid (bsdf.h). Then n_o^2 f_t(wi, wo) = n_i^2 f_t(wo, wi), and the same f
/// scatters a photon, which carries watts, with the photon's own direction as wo. Thin wall, as in
/// KHR_materials_transmission: f_t = (1 - F) x the reflected lobe without F, mirrored at the surface, so that light
/// goes straighter through a smoother wall.
///
/// The share 1 - E of light, which meets several microfacets, is distributed over both sides as by Kulla & Conty
/// (2017):
///     f_ms(wi, wo) = share (1 - E(wi)) (1 - E(wo)) / (pi (1 - E_mean(side of wi))).
/// The share of the transmitted side is b for wo outside and d for wo inside. Reciprocity requires
///     b / d = n^2 (1 - E_mean,in) / (1 - E_mean,out).
/// b is 1 - F_mean, or smaller if d would exceed 1. The reflected side has the remaining share. No light is lost.
class RoughGlass {
 public:
  /// `index` >= 1 is that of the solid, alpha in (0, 1] that of GGX. outside: wo is outside the solid; no effect for a
  /// thin wall.
  RoughGlass(float index, float alpha, bool thin, bool outside);

  float eval(Vec3 wi, Vec3 wo) const;             ///< f [1/sr], without a tint
  float pdf_solid_angle(Vec3 wi, Vec3 wo) const;  ///< pdf with which sample() draws wi [1/sr]
  /// Draws a direction wi above or below the surface; all numbers are in [0, 1). The weight of the sample is eval
  /// |cos_i| / pdf. If wi.z = 0 the weight is 0: a microfacet has sent light to the wrong side of the surface.
  Vec3 sample(Vec3 wo, float u_lobe, Vec2 u) const;

 private:
  /// For two directions, f of single scattering [1/sr], and the pdf of wi by visible normals [1/sr].
  struct Pair {
    float f = 0, pdf_solid_angle = 0;
  };
  Pair single(Vec3 wi, Vec3 wo) const;
  float loss(bool behind, float cos_theta) const;
  float mean_loss(bool behind) const;
  float multiple_pdf_solid_angle(float cos_i) const;

  GlassLoss loss_;  ///< for a solid
  GgxAlbedo wall_;  ///< for a thin wall: the albedo of a mirror
  float alpha_, alpha2_;
  float eta_;  ///< index on wo's side / index on the other side, for the Fresnel term
  bool thin_;
  int side_;                    ///< side of wo: 0 outside, 1 inside
  float share_behind_;          ///< share of f_ms on the other side
  float spread2_, log_spread_;  ///< spread^2 and log(1 + 1 / spread^2) of multiple_pdf_solid_angle()
};

}  // namespace tempolux
