// lib/material/tables/ggx_integrals.h -- the albedo of GGX by quadrature: what the table of albedo.h holds.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace tempolux::integrals {

/// Nodes and weights of Gauss and Legendre on [0, 1].
struct GaussLegendre {
  std::vector<double> x, weight;
  explicit GaussLegendre(int n) {
    for (int i = 0; i < n; ++i) {
      double z = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0;
      for (double step = 1; std::abs(step) > 1e-15; z -= step) {
        double p = 1, before = 0;
        for (int j = 0; j < n; ++j) {
          const double older = before;
          before = p;
          p = ((2 * j + 1) * z * before - j * older) / (j + 1);
        }
        slope = n * (z * p - before) / (z * z - 1);
        step = p / slope;
      }
      x.push_back(0.5 * (1 - z));
      weight.push_back(1 / ((1 - z * z) * slope * slope));
    }
  }
};

/// The directional albedo of GGX.
struct Albedo {
  double total, b;  ///< E at F = 1; its part with Fresnel's factor (1 - wo h)^5
};

/// The integrals of D G2 / (4 cos_o cos_i) cos_i and of the same times (1 - u)^5 over wi, where u = wo h. The variable
/// is the half vector h, with dwi = 4 u dh. Its angle is written as tan = alpha q, since t = q^2 / (1 + q^2) is uniform
/// under D cos_h. The range of t is cut where the ring of half vectors at one angle begins to reflect below the horizon
/// (2 angle(h) = 90 deg - angle(wo)), and it ends where the whole ring does (2 angle(h) = 90 deg + angle(wo)).
inline Albedo ggx_albedo(double cos_o, double alpha, const GaussLegendre& rule) {
  const double pi = std::numbers::pi, a2 = alpha * alpha, sin_o = std::sqrt(std::max(0.0, 1 - cos_o * cos_o));
  const double root_o = std::sqrt(a2 + (1 - a2) * cos_o * cos_o), angle_o = std::acos(cos_o);
  const auto t_of = [&](double angle) {
    const double q = std::tan(angle) / alpha;
    return q * q / (1 + q * q);
  };
  const double cut[3] = {0, t_of((pi / 2 - angle_o) / 2), t_of(pi / 4 + angle_o / 2)};
  Albedo sum{0, 0};
  for (int part = 0; part < 2; ++part) {
    const double width = cut[part + 1] - cut[part];
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
      const double v = rule.x[i], t = cut[part] + width * v * v * v * (10 - 15 * v + 6 * v * v);
      const double dt = width * 30 * v * v * (1 - v) * (1 - v) * rule.weight[i];
      const double tan2 = a2 * t / (1 - t), c = 1 / std::sqrt(1 + tan2), s = std::sqrt(tan2) * c;
      const double cos_end = (cos_o / (2 * c) - cos_o * c) / std::max(1e-300, sin_o * s);
      const double phi_end = part == 0 || cos_end <= -1 ? pi : cos_end >= 1 ? 0 : std::acos(cos_end);
      for (std::size_t j = 0; j < rule.x.size(); ++j) {
        const double x = rule.x[j], phi = phi_end * (1 - x * x * x * x);
        const double u = sin_o * s * std::cos(phi) + cos_o * c, cos_i = 2 * u * c - cos_o;
        if (!(cos_i > 0) || !(u > 0)) continue;
        const double root_i = std::sqrt(a2 + (1 - a2) * cos_i * cos_i);
        const double visibility = 0.5 / (cos_o * root_i + cos_i * root_o);
        const double d_phi = 4 * x * x * x * phi_end * rule.weight[j];
        const double f = visibility * cos_i * 4 * u / c * d_phi * dt / pi, k = 1 - u;
        sum.total += f;
        sum.b += f * k * k * k * k * k;
      }
    }
  }
  return sum;
}

/// 2 integral_0^1 ggx_albedo(mu) mu dmu. The variable is v with mu = v^3, because the albedo bends where mu is about
/// alpha.
inline Albedo ggx_mean_albedo(double alpha, const GaussLegendre& outer, const GaussLegendre& rule) {
  Albedo sum{0, 0};
  for (std::size_t i = 0; i < outer.x.size(); ++i) {
    const double v = outer.x[i], mu = v * v * v, weight = 2 * mu * 3 * v * v * outer.weight[i];
    const Albedo e = ggx_albedo(mu, alpha, rule);
    sum.total += weight * e.total;
    sum.b += weight * e.b;
  }
  return sum;
}

}  // namespace tempolux::integrals
