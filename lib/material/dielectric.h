// lib/material/dielectric.h -- smooth boundaries of glass: exact Fresnel reflectance and refraction.
#pragma once

#include <cmath>

#include "lib/core/vec.h"

namespace tempolux {

/// Reflectance [1] of a smooth boundary for unpolarised light, by Fresnel's equations; 1 if all light is reflected.
/// cos_o in (0, 1] is the cosine on wo's side; eta = (index on wo's side) / (index on the other side). cos_t receives
/// the cosine on the other side, 0 if all light is reflected.
inline float fresnel_dielectric(float cos_o, float eta, float& cos_t) {
  const float sin2_t = eta * eta * std::max(0.0f, 1 - cos_o * cos_o);
  if (sin2_t >= 1) {
    cos_t = 0;
    return 1;
  }
  cos_t = std::sqrt(1 - sin2_t);
  const float parallel = (cos_o - eta * cos_t) / (cos_o + eta * cos_t);
  const float perpendicular = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// Reflectance [1] of a boundary of relative index `index` at normal incidence.
inline float normal_reflectance(float index) {
  const float r = (index - 1) / (index + 1);
  return r * r;
}

/// Snell's law: the direction on the other side of the boundary z = 0 from which refracted light reaches wo (z > 0).
/// Unit, away from the surface, z < 0. cos_t is that of fresnel_dielectric, above 0.
inline Vec3 refract(Vec3 wo, float eta, float cos_t) { return normalize(Vec3{-eta * wo.x, -eta * wo.y, -cos_t}); }

}  // namespace tempolux
