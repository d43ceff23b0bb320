// lib/material/glass_albedo.h -- the share of light that a rough glass boundary loses if each ray meets a single
// microfacet.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/material/albedo.h"

namespace tempolux {

/// The lost share 1 - E [1] of the lobe of rough_glass.h, for one alpha and one index. E is the share of uniform light
/// that the lobe reflects and transmits towards one direction, outside or inside of the glass. 1 - E is interpolated
/// cubically in a table (tables/make_tables.cpp), within 3e-3 of the integrals
/// (tests/lib/material/glass_albedo_test.cpp).
///
/// Planes of the table are at equal steps of sqrt(1 - 1/index), rows at equal steps of sqrt(alpha). Outside, columns
/// are at equal steps of sqrt(x), where x = cos (1 + alpha) / (cos + alpha). Inside, the loss has a kink at the
/// critical angle, so that angle is the middle column, and columns are denser close to it.
class GlassLoss {
 public:
  /// index >= 1 and alpha of GGX are clamped to the table's range. Side 0 is outside of the glass, side 1 inside.
  GlassLoss(float index, float alpha);
  /// 1 - E for light towards cos_theta in (0, 1]; at least 0.
  float at(int side, float cos_theta) const;
  /// Cosine-weighted mean over the hemisphere: 2 integral_0^1 at(mu) mu dmu; at least 5e-5. RoughGlass sends the lost
  /// light out again with the weight at(mu) / mean. With a smaller mean, grazing light would weigh more than 50.
  float mean(int side) const;

 private:
  float column(int side, float cos_theta) const;

  float alpha_;
  float critical_;      ///< cosine of the critical angle
  int first_[2];        ///< first of the four planes and of the four rows used for interpolation
  float weight_[2][4];  ///< weights of these four planes and rows
};

namespace glass_table {
inline constexpr int kPlanes = 11, kRows = 15, kColumns = 24;
extern const float kLoss[2][kPlanes][kRows][kColumns];
extern const float kMean[2][kPlanes][kRows];

/// index, alpha and cosine of a position in the table: 0 is the first plane, row or column, 1 the last.
inline double index_of_plane(double position) { return position < 1 ? 1 / (1 - position * position) : 1e4; }
inline double alpha_of_row(double position) { return std::max(position * position, albedo_table::kMinAlpha); }
inline double cos_of_column(int side, double index, double position, double alpha) {
  const auto cos_of = [&](double root) { return alpha * root * root / (1 + alpha - root * root); };
  double cos = 0;
  if (side == 0) {
    cos = cos_of(position);
  } else {
    const double critical = std::sqrt(1 - 1 / (index * index));
    const double root = std::sqrt(critical * (1 + alpha) / (critical + alpha));
    const double s = 2 * position;
    cos = s <= 1 ? cos_of(s * (2 - s) * root) : critical + (s - 1) * (s - 1) * (1 - critical);
  }
  return std::max(cos, 1e-6 * alpha);
}
}  // namespace glass_table

}  // namespace tempolux
