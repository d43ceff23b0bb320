// lib/material/tables/sheen_integrals.h -- the albedo of the sheen lobe by quadrature.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/material/sheen.h"
#include "lib/material/tables/ggx_integrals.h"

namespace tempolux::integrals {

/// The integral over wi of sheen_formula() x cos_i x weight(cos_i). Nodes are dense at grazing angles, and where wi is
/// opposite to wo.
template <class Weight>
double sheen_integral(double cos_o, double alpha, const GaussLegendre& rule, const Weight& weight) {
  const double pi = std::numbers::pi, sin_o = std::sqrt(std::max(0.0, 1 - cos_o * cos_o));
  double sum = 0;
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    const double v = rule.x[i], cos_i = v * v * v, sin_i = std::sqrt(1 - cos_i * cos_i);
    double ring = 0;
    for (std::size_t j = 0; j < rule.x.size(); ++j) {
      const double x = rule.x[j], phi = pi * x * x * (3 - 2 * x);
      const double hx = sin_i * std::cos(phi) + sin_o, hy = sin_i * std::sin(phi), hz = cos_i + cos_o;
      const double sin2_h = (hx * hx + hy * hy) / (hx * hx + hy * hy + hz * hz);
      ring += sheen_formula(cos_i, cos_o, sin2_h, alpha) * pi * 6 * x * (1 - x) * rule.weight[j];
    }
    sum += 2 * ring * cos_i * 3 * v * v * rule.weight[i] * weight(cos_i);
  }
  return sum;
}

}  // namespace tempolux::integrals
