// lib/material/bsdf.h -- scattering at a surface: a Lambert lobe (event D) and other lobes (event S).
#pragma once

#include "lib/core/vec.h"
#include "lib/scene/scene.h"

namespace tempolux {

/// Scattering of one material at one point, in the local frame of the shading normal (z = normal).
///
/// f = f_D + f_S. f_D is the Lambert lobe base_color (1 - metallic) / pi, coupled to the reflection above it
/// so that the whole never reflects more than it receives, from either side:
///     f_D(wi, wo) = rho/pi  c(wo) c(wi),   c(w) = (1 - A_S(w)) / sqrt(1 - A_S,mean)
/// with A_S the directional albedo of the S lobes; c = 1 exactly for a matte material (Kelemen &
/// Szirmay-Kalos 2001). f_S is GGX with Smith's height-correlated masking and Schlick's Fresnel term, a delta
/// mirror below a roughness of kMirrorRoughness. wi and wo point away from the surface; both on the side
/// z > 0, else f = 0 (transmission is not part of this version).
class Bsdf {
 public:
  explicit Bsdf(const Material& material);

  bool has_diffuse() const { return diffuse_; }
  bool has_specular() const { return specular_; }
  bool specular_is_delta() const { return delta_; }
  /// rho of the Lambert lobe, before coupling.
  Rgb diffuse_albedo() const { return rho_; }
  /// c(w) above, 1 for a matte material; cos_theta > 0.
  float diffuse_coupling(float cos_theta) const;
  /// What the Lambert lobe reflects of uniform light towards wo: rho (1 - A_S(wo)), rho for a matte material.
  Rgb diffuse_reflectance(float cos_o) const;
  /// Factor for light arriving from wi before it is averaged into an irradiance E, so that f_D's radiance is
  /// diffuse_reflectance(cos_o) E / pi exactly: (1 - A_S(wi)) / (1 - A_S,mean), 1 for a matte material.
  float arrival_weight(float cos_i) const;

  /// f_D and f_S apart [1/sr]; without the cosine. Delta lobes evaluate to 0.
  Rgb eval_diffuse(Vec3 wi, Vec3 wo) const;
  Rgb eval_specular(Vec3 wi, Vec3 wo) const;

  struct Sample {
    Vec3 wi{};                 ///< unit, away from the surface
    Rgb weight{0.0f};          ///< f cos / pdf of the chosen lobe's component, divided by its choice probability
    float pdf_solid_angle = 0; ///< of wi by all non-delta lobes [1/sr]; for a delta lobe its choice probability
    bool diffuse = false;      ///< event D, else S
    bool delta = false;
  };
  /// Draws wi given wo: lobe by u_lobe, direction by u. weight is for the chosen event alone: the event D
  /// carries f_D cos / (P(D) pdf_D), the event S carries f_S cos / (P(S) pdf_S), so that light paths can be
  /// told apart. Zero weight if wo is below the surface or nothing is reflected.
  Sample sample(Vec3 wo, float u_lobe, Vec2 u) const;
  /// Density of sample() choosing wi by event D, by event S [1/sr], choice probability included.
  float pdf_diffuse(Vec3 wi, Vec3 wo) const;
  float pdf_specular(Vec3 wi, Vec3 wo) const;

 private:
  float diffuse_probability(float cos_o) const;

  Rgb rho_{0.0f}, f0_{0.0f}, f90_{0.0f};
  float alpha_ = 1, mean_albedo_ = 0;
  bool diffuse_ = false, specular_ = false, delta_ = false;
};

inline constexpr float kMirrorRoughness = 0.02f;  ///< below: a delta mirror

}  // namespace tempolux
