// lib/material/albedo.h -- directional albedo of the GGX lobe, from a table.
#pragma once

#include <algorithm>
#include <cmath>

namespace tempolux {

/// Albedo of the lobe as E = F0 a + F90 b. E is the share of uniform light that the lobe reflects; Schlick's Fresnel
/// term is linear in F0 and F90, so a and b do not depend on them. [1]
struct AlbedoPair {
  float a = 0, b = 0;
};

namespace albedo_table {
inline constexpr int kRows = 28, kColumns = 48;
inline constexpr double kMinAlpha = 0.0004;  ///< kMirrorRoughness^2
}  // namespace albedo_table

/// Albedo of the single-scattering lobe of ggx.h for one alpha, by bicubic interpolation in a table that the build
/// computes (tables/make_tables.cpp). Rows are at equal steps of alpha^(1/4), columns at equal steps of sqrt(x), with
///     x = cos (1 + alpha) / (cos + alpha).
/// a + b is within 5e-5 of the integral and b within 8e-5, over the whole domain
/// (tests/lib/material/albedo_table_test.cpp).
class GgxAlbedo {
 public:
  /// alpha of GGX, clamped to the table's range [kMinAlpha, 1].
  explicit GgxAlbedo(float alpha);
  /// For alpha 1, without a search in the table, since every hit on a matte material makes one.
  GgxAlbedo() = default;

  /// Albedo for light from a direction at this cosine to the normal, in (0, 1].
  AlbedoPair at(float cos_theta) const;
  /// Cosine-weighted mean over the hemisphere: 2 integral_0^1 at(mu) mu dmu.
  AlbedoPair mean() const;

 private:
  float alpha_ = 1;
  int row_ = albedo_table::kRows - 4;  ///< first of the four rows used for interpolation
  float weight_[4] = {0, 0, 0, 1};     ///< weights of these rows
};

namespace albedo_table {
/// a and b from the table's E and m, with sum = cos + alpha.
inline AlbedoPair split(float total, float m, float sum) {
  total = std::clamp(total, 0.0f, 1.0f);
  const float k = std::clamp(1 - m * sum, 0.0f, 1.0f), k2 = k * k, b = total * k2 * k2 * k;
  return {total - b, b};
}

extern const float kTotal[kColumns][kRows];   ///< E at F = 1: a + b
extern const float kCosine[kColumns][kRows];  ///< m, from which b = E (1 - m (cos + alpha))^5
extern const float kMeanA[kRows], kMeanB[kRows];

/// alpha and cosine of a position in the table: 0 is the first row or column, 1 the last.
inline double alpha_of_row(double position) {
  const double first = std::pow(kMinAlpha, 0.25), root = first + position * (1 - first);
  return root * root * root * root;
}
inline double cos_of_column(double position, double alpha) {
  const double x = position * position;
  return alpha * x / (1 + alpha - x);
}
}  // namespace albedo_table

}  // namespace tempolux
