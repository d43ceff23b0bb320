// lib/material/tables/anisotropic_integrals.h -- the albedo of anisotropic GGX by quadrature.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/material/tables/ggx_integrals.h"

namespace tempolux::integrals {

/// The directional albedo towards a direction at this cosine, and at `angle` to the axis of alpha_t: the mean of G2 /
/// G1 over 2n x n visible normals (Heitz, JCGT 7(4), 2018), and the same times (1 - wo h)^5.
inline Albedo anisotropic_albedo(double cos_o, double angle, double alpha_t, double alpha_b, int n) {
  const double pi = std::numbers::pi, sin_o = std::sqrt(std::max(0.0, 1 - cos_o * cos_o));
  const double o[3] = {sin_o * std::cos(angle), sin_o * std::sin(angle), cos_o};
  const auto lambda = [&](double x, double y, double z) {
    return (std::sqrt(1 + (alpha_t * alpha_t * x * x + alpha_b * alpha_b * y * y) / (z * z)) - 1) / 2;
  };
  double s[3] = {o[0] * alpha_t, o[1] * alpha_b, o[2]};
  const double length = std::hypot(s[0], s[1], s[2]), lambda_o = lambda(o[0], o[1], o[2]);
  for (double& x : s) x /= length;
  Albedo sum{0, 0};
  for (int i = 0; i < 2 * n; ++i) {
    const double phi = pi * (i + 0.5) / n, c = std::cos(phi), d = std::sin(phi);
    for (int j = 0; j < n; ++j) {
      const double z = (1 - (j + 0.5) / n) * (1 + s[2]) - s[2], r = std::sqrt(std::max(0.0, 1 - z * z));
      double h[3] = {(r * c + s[0]) * alpha_t, (r * d + s[1]) * alpha_b, std::max(z + s[2], 1e-12)};
      const double l = std::hypot(h[0], h[1], h[2]);
      for (double& x : h) x /= l;
      const double u = o[0] * h[0] + o[1] * h[1] + o[2] * h[2], cos_i = 2 * u * h[2] - o[2];
      if (!(cos_i > 0)) continue;
      const double ratio = (1 + lambda_o) / (1 + lambda_o + lambda(2 * u * h[0] - o[0], 2 * u * h[1] - o[1], cos_i));
      const double k = std::max(0.0, 1 - u);
      sum.total += ratio;
      sum.b += ratio * k * k * k * k * k;
    }
  }
  const double count = 2.0 * n * n;
  return {sum.total / count, sum.b / count};
}

}  // namespace tempolux::integrals
