// lib/material/tables/nodes.h -- the numbers that the tables of albedo.h and glass_albedo.h hold at their nodes.
#pragma once

#include <algorithm>

#include "lib/material/albedo.h"
#include "lib/material/anisotropic_ggx.h"
#include "lib/material/cubic_weights.h"
#include "lib/material/glass_albedo.h"
#include "lib/material/tables/anisotropic_integrals.h"
#include "lib/material/tables/ggx_integrals.h"
#include "lib/material/tables/glass_integrals.h"
#include "lib/material/tables/sheen_integrals.h"

namespace tempolux::albedo_table {

/// E at F = 1 and m of albedo.h, at a position between the columns.
inline integrals::Albedo entry(int row, double position, const integrals::GaussLegendre& rule) {
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double mu = std::clamp(cos_of_column(position, alpha), 1e-6 * alpha, 1.0);
  integrals::Albedo e = integrals::ggx_albedo(mu, alpha, rule);
  if (position == 0) e.total = 1;  // the limit: what grazes the surface is mirrored, nothing is masked twice
  return {e.total, (1 - std::pow(e.b / e.total, 0.2)) / (mu + alpha)};
}

/// The values of a node. The fifth power bends sharply close to normal incidence, where b is below 1e-5 and m has no
/// weight: the m of the last column is chosen so that the cubic is exact at cos = 0.5, or in the middle of the last
/// interval if that is closer to the end.
inline integrals::Albedo node(int row, int column, const integrals::GaussLegendre& rule) {
  integrals::Albedo e = entry(row, double(column) / (kColumns - 1), rule);
  if (column < kColumns - 1) return e;
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double at = std::max(std::sqrt(0.5 * (1 + alpha) / (0.5 + alpha)), 1 - 0.5 / (kColumns - 1));
  float weight[4];
  cubic_weights(float(at), kColumns, weight);
  double rest = entry(row, at, rule).b;
  for (int i = 0; i < 3; ++i) rest -= weight[i] * entry(row, double(kColumns - 4 + i) / (kColumns - 1), rule).b;
  e.b = rest / weight[3];
  return e;
}

}  // namespace tempolux::albedo_table

namespace tempolux {

/// Cosine-weighted mean, 2 integral_0^1 V(mu) mu dmu, of values V that a lobe interpolates between columns: midpoints
/// of `steps` equal steps of the column's position. cos_at: cosine at a position from 0 to 1.
template <class Cos>
double mean_of_columns(const std::vector<double>& values, int steps, const Cos& cos_at) {
  double sum = 0, before = 0;
  for (int i = 0; i < steps; ++i) {
    float weight[4];
    const int first = cubic_weights(float((i + 0.5) / steps), int(values.size()), weight);
    double value = 0;
    for (int k = 0; k < 4; ++k) value += double(weight[k]) * values[std::size_t(first + k)];
    const double cos = cos_at((i + 1.0) / steps);
    sum += std::clamp(value, 0.0, 1.0) * (cos * cos - before * before);
    before = cos;
  }
  return sum;
}

}  // namespace tempolux

namespace tempolux::glass_table {

/// Index on the side of the incident direction over the index on the other side. Side 0 is outside of the glass.
inline double eta_of(int side, double index) { return side == 0 ? 1 / index : index; }

/// The loss at a node by n x n/2 visible normals.
inline double node(int side, int plane, int row, int column, int n) {
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double index = index_of_plane(double(plane) / (kPlanes - 1));
  const double cos = cos_of_column(side, index, double(column) / (kColumns - 1), alpha);
  return integrals::glass_loss(cos, alpha, eta_of(side, index), n);
}

/// Cosine-weighted mean of the values of one row, by column, as GlassLoss interpolates them.
inline double mean_of_row(int side, int plane, int row, const std::vector<double>& values) {
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double index = index_of_plane(double(plane) / (kPlanes - 1));
  return mean_of_columns(values, 16384, [&](double position) { return cos_of_column(side, index, position, alpha); });
}

}  // namespace tempolux::glass_table

namespace tempolux::anisotropic_table {

/// E and m at a node, by 64 x 32 visible normals.
inline integrals::Albedo node(int row, int width, int column, int turn) {
  const double b = albedo_table::alpha_of_row(double(row) / (kRows - 1)),
               t = alpha_t_of(b, double(width) / (kWidths - 1));
  const double angle = angle_of(double(turn) / (kTurns - 1)), alpha = alpha_at(t, b, angle);
  const double mu = albedo_table::cos_of_column(double(column) / (kColumns - 1), alpha);
  const double cos = std::clamp(mu, 1e-6 * b, 1.0);
  const integrals::Albedo e = integrals::anisotropic_albedo(cos, angle, t, b, 32);
  return {e.total, (1 - std::pow(e.b / e.total, 0.2)) / (cos + alpha)};
}

/// Cosine-weighted means of E and b that AnisotropicGgx interpolates between a row's nodes, by midpoints of steps of
/// the positions.
inline integrals::Albedo mean_of(int row, int width, const std::vector<integrals::Albedo>& nodes) {
  const double b = albedo_table::alpha_of_row(double(row) / (kRows - 1)),
               t = alpha_t_of(b, double(width) / (kWidths - 1));
  constexpr int kSteps = 256, kAngles = 64;
  integrals::Albedo sum{0, 0};
  for (int a = 0; a < kAngles; ++a) {
    const double turn = (a + 0.5) / kAngles, alpha = alpha_at(t, b, angle_of(turn));
    float around[4], across[4];
    const int first = cubic_weights(float(turn), kTurns, around);
    double before = 0;
    for (int i = 0; i < kSteps; ++i) {
      const int column = cubic_weights(float((i + 0.5) / kSteps), kColumns, across);
      const double cos = albedo_table::cos_of_column((i + 1.0) / kSteps, alpha),
                   weight = (cos * cos - before * before) / kAngles;
      const double middle = albedo_table::cos_of_column((i + 0.5) / kSteps, alpha);
      double total = 0, m = 0;
      before = cos;
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          const integrals::Albedo& e = nodes[std::size_t((column + k) * kTurns + first + l)];
          total += double(across[k] * around[l]) * e.total;
          m += double(across[k] * around[l]) * e.b;
        }
      sum.total += weight * total;
      sum.b += weight * total * std::pow(std::clamp(1 - m * (middle + alpha), 0.0, 1.0), 5);
    }
  }
  return sum;
}

}  // namespace tempolux::anisotropic_table

namespace tempolux::sheen_table {

/// The values of one row.
struct Row {
  std::vector<double> albedo, raw;  ///< albedo for white, and E, by column

  Row(double position, const integrals::GaussLegendre& rule) {
    const double r = roughness_of_row(position), alpha = r * r;
    const auto one = [](double) { return 1.0; };
    std::vector<double> e;  // E at the nodes of the rule
    for (const double x : rule.x) e.push_back(integrals::sheen_integral(x * x * x, alpha, rule, one));
    for (int column = 0; column < kColumns; ++column) {
      const double cos = cos_of_column(double(column) / (kColumns - 1));
      raw.push_back(integrals::sheen_integral(cos, alpha, rule, one));
      std::size_t at = 0;
      albedo.push_back(integrals::sheen_integral(cos, alpha, rule, [&](double) {
        return 1 / std::max({1.0, raw.back(), e[at++]});
      }));
    }
  }
  /// Cosine-weighted mean of the values that Sheen interpolates.
  double mean() const {
    return mean_of_columns(albedo, 4096, [](double position) { return std::pow(position, 3); });
  }
};

}  // namespace tempolux::sheen_table
