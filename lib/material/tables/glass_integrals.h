// lib/material/tables/glass_integrals.h -- what one microfacet of rough glass loses, by quadrature.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tempolux::integrals {

/// Exact Fresnel reflectance in double; eta = index on the side of the incident direction / index on the other side.
inline double fresnel(double cos_o, double eta, double& cos_t) {
  const double sin2 = eta * eta * (1 - cos_o * cos_o);
  cos_t = sin2 >= 1 ? 0 : std::sqrt(1 - sin2);
  if (sin2 >= 1) return 1;
  const double p = (cos_o - eta * cos_t) / (cos_o + eta * cos_t), s = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
  return 0.5 * (p * p + s * s);
}

/// 1 - E: mean over n x n/2 visible normals (half of them: the others mirror these) of 1 - G2/G1, or 1 where the
/// direction ends up on the wrong side.
inline double glass_loss(double cos_o, double alpha, double eta, int n) {
  const double sin_o = std::sqrt(std::max(0.0, 1 - cos_o * cos_o)), a2 = alpha * alpha;
  const auto lambda = [&](double c) { return (std::sqrt(a2 + (1 - a2) * c * c) / c - 1) / 2; };
  const double size = std::hypot(sin_o * alpha, cos_o), sx = sin_o * alpha / size, sz = cos_o / size;
  const double over = 1 + lambda(cos_o);
  double kept = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n / 2; ++j) {
      const double phi = std::numbers::pi * (j + 0.5) / (n / 2), z = 1 - (i + 0.5) / n * (1 + sz);
      const double r = std::sqrt(std::max(0.0, 1 - z * z));
      double hx = (r * std::cos(phi) + sx) * alpha, hy = r * std::sin(phi) * alpha, hz = z + sz;
      const double length = std::sqrt(hx * hx + hy * hy + hz * hz);
      hx /= length, hy /= length, hz /= length;
      const double oh = std::clamp(sin_o * hx + cos_o * hz, 0.0, 1.0);
      double cos_t;
      const double f = fresnel(oh, eta, cos_t);
      if (const double up = 2 * oh * hz - cos_o; up > 0) kept += f * over / (over + lambda(up));
      if (const double down = -((eta * oh - cos_t) * hz - eta * cos_o); down > 0 && f < 1)
        kept += (1 - f) * over / (over + lambda(down));
    }
  return 1 - kept / (double(n) * (n / 2));
}

}  // namespace tempolux::integrals
