// lib/material/tables/nodes.h -- the numbers that the tables of albedo.h and glass_albedo.h hold at their nodes.
#pragma once

#include <algorithm>

#include "lib/material/albedo.h"
#include "lib/material/cubic_weights.h"
#include "lib/material/glass_albedo.h"
#include "lib/material/tables/ggx_integrals.h"
#include "lib/material/tables/glass_integrals.h"

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

/// Cosine-weighted mean of one row, 2 integral_0^1 L(mu) mu dmu, of the values L that GlassLoss interpolates between
/// the row's columns: midpoints of 16384 equal steps of the column's position.
inline double mean_of_row(int side, int plane, int row, const std::vector<double>& values) {
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double index = index_of_plane(double(plane) / (kPlanes - 1));
  const int steps = 16384;
  double sum = 0, before = 0;
  for (int i = 0; i < steps; ++i) {
    float weight[4];
    const int first = cubic_weights(float((i + 0.5) / steps), kColumns, weight);
    double loss = 0;
    for (int k = 0; k < 4; ++k) loss += weight[k] * values[std::size_t(first + k)];
    const double cos = cos_of_column(side, index, (i + 1.0) / steps, alpha);
    sum += std::clamp(loss, 0.0, 1.0) * (cos * cos - before * before);
    before = cos;
  }
  return sum;
}

}  // namespace tempolux::glass_table
