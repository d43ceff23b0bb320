// lib/material/ggx.h -- the GGX microfacet lobe with Smith's height-correlated masking; local frame, z = normal.
//
// Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; Heitz, "Understanding the
// Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014. The lobe is isotropic. In all functions
// alpha is in (0, 1], alpha2 is its square, directions are unit and away from the surface, and cosines are positive.
// No divisor can be 0.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"
#include "lib/core/vec.h"

namespace tempolux::ggx {

/// sqrt(alpha^2 + (1 - alpha^2) cos^2): Smith's Lambda is (root / cos - 1) / 2.
inline float smith_root(float cos_theta, float alpha2) {
  return std::sqrt(alpha2 + (1 - alpha2) * cos_theta * cos_theta);
}

/// Density D(h) of microfacet normals [1/sr] at the unit half vector h. The function uses h.x and h.y, which keep
/// their digits when h is close to z.
inline float distribution(Vec3 h, float alpha2) {
  // h = 0 if wi = -wo; for other h the sum is at least 1, up to rounding
  const float slope = std::max(1.0f, (h.x * h.x + h.y * h.y) / alpha2 + h.z * h.z);
  return kInvPi / (alpha2 * slope * slope);
}

/// G2 / (4 cos_i cos_o) [1]; the lobe is f = F D visibility. At most 5e19, for cosines below 1e-20.
inline float visibility(float cos_i, float cos_o, float alpha2) {
  return 0.5f / std::max(1e-20f, cos_o * smith_root(cos_i, alpha2) + cos_i * smith_root(cos_o, alpha2));
}

/// Draws a half vector with the pdf of visible normals, D(h) G1(wo) max(0, wo h) / cos_o [1/sr], of GGX with the widths
/// alpha_x and alpha_y along x and y; u in [0, 1)^2.
/// Method: a uniform point of the spherical cap of directions into which the stretched view reflects. Heitz,
/// "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018, with the mapping of Dupuy & Benyoub,
/// "Sampling Visible GGX Normals with Spherical Caps", CGF 42(8), 2023.
inline Vec3 sample_visible_normal(Vec3 wo, float alpha_x, float alpha_y, Vec2 u) {
  const Vec3 stretched = normalize(Vec3{wo.x * alpha_x, wo.y * alpha_y, wo.z});
  const float phi = 2 * kPi * u.x;
  const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
  const float r = std::sqrt(std::clamp(1 - z * z, 0.0f, 1.0f));
  const Vec3 h = Vec3{r * std::cos(phi), r * std::sin(phi), z} + stretched;
  return normalize(Vec3{h.x * alpha_x, h.y * alpha_y, std::max(h.z, 1e-7f)});
}

/// pdf [1/sr] of the direction wi = 2 (wo h) h - wo if h is drawn by sample_visible_normal:
///     D G1(wo) / (4 cos_o) = D / (2 (cos_o + smith_root(cos_o)))
inline float pdf_reflected(Vec3 h, float cos_o, float alpha2) {
  return distribution(h, alpha2) * 0.5f / (cos_o + smith_root(cos_o, alpha2));
}

}  // namespace tempolux::ggx
