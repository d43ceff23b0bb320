// lib/material/tables/glass_integrals.h -- what one microfacet of rough glass loses, by quadrature.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace tempolux::integrals {

/// Exact Fresnel reflectance in double; eta = index on the side of the incident direction / index on the other side.
inline double fresnel(double cos_o, double eta, double& cos_t) {
  const double sin2 = eta * eta * (1 - cos_o * cos_o);
  cos_t = std::sqrt(std::max(0.0, 1 - sin2));
  const double p = (cos_o - eta * cos_t) / (cos_o + eta * cos_t), s = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
  return sin2 >= 1 ? 1 : 0.5 * (p * p + s * s);
}

/// 1 - E [1]: the mean over visible normals of 1 - G2/G1, or of 1 if the direction is on the wrong side of the surface.
/// n x n/2 normals suffice, since the others are their mirror images. The inner loop has no branch and no sum, so that
/// vector lanes run it.
inline double glass_loss(double cos_o, double alpha, double eta, int n) {
  const double sin_o = std::sqrt(std::max(0.0, 1 - cos_o * cos_o)), a2 = alpha * alpha;
  const auto lambda = [=](double c) { return (std::sqrt(a2 + (1 - a2) * c * c) / c - 1) / 2; };
  const double size = std::hypot(sin_o * alpha, cos_o), sx = sin_o * alpha / size, sz = cos_o / size;
  const double over = 1 + lambda(cos_o);
  const std::size_t half = std::size_t(n / 2);
  std::vector<double> cos_phi(half), sin_phi(half), reflected(half), passed(half);
  for (std::size_t j = 0; j < half; ++j) {
    const double phi = std::numbers::pi * (double(j) + 0.5) / double(half);
    cos_phi[j] = std::cos(phi), sin_phi[j] = std::sin(phi);
  }
  double kept = 0;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (i + 0.5) / n * (1 + sz), r = std::sqrt(std::max(0.0, 1 - z * z));
    for (std::size_t j = 0; j < half; ++j) {
      const double x = (r * cos_phi[j] + sx) * alpha, y = r * sin_phi[j] * alpha, h = z + sz;
      const double length = std::sqrt(x * x + y * y + h * h), hx = x / length, hz = h / length;
      const double oh = std::min(std::max(sin_o * hx + cos_o * hz, 0.0), 1.0);
      double cos_t;
      const double f = fresnel(oh, eta, cos_t);
      const double up = 2 * oh * hz - cos_o, down = eta * cos_o - (eta * oh - cos_t) * hz;
      const double of_up = f * over / (over + lambda(up)), of_down = (1 - f) * over / (over + lambda(down));
      reflected[j] = up > 0 ? of_up : 0;
      passed[j] = down > 0 && f < 1 ? of_down : 0;
    }
    for (std::size_t j = 0; j < half; ++j) kept += reflected[j], kept += passed[j];
  }
  return 1 - kept / (double(n) * (n / 2));
}

}  // namespace tempolux::integrals
