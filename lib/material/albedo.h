// lib/material/albedo.h -- directional albedo of the GGX lobe, from a table.
#pragma once

#include <cmath>

namespace tempolux {

/// Albedo E = F0 a + F90 b: the share of uniform light that the lobe reflects, with Schlick's Fresnel term split into
/// its two linear parts. [1]
struct AlbedoPair {
  float a = 0, b = 0;
};

namespace albedo_table {
inline constexpr int kRows = 28, kColumns = 48;
inline constexpr double kMinAlpha = 0.0004;
}  // namespace albedo_table

/// Albedo of the single-scattering lobe of ggx.h for one alpha. Bicubic interpolation in a table of 28 x 48 entries
/// (albedo_table.cpp) over alpha^(1/4) and the square root of x = cos (1 + alpha) / (cos + alpha). a + b is within 5e-5
/// and b within 8e-5 of the integrals over the whole domain (tested).
class GgxAlbedo {
 public:
  /// alpha is clamped to [0.0004, 1], the range of the table.
  explicit GgxAlbedo(float alpha);
  /// For alpha 1: cheap, because every hit on a matte material makes one.
  GgxAlbedo() = default;

  /// Albedo for light towards cos_theta in (0, 1].
  AlbedoPair at(float cos_theta) const;
  /// Cosine-weighted mean over the hemisphere: 2 integral_0^1 at(mu) mu dmu.
  AlbedoPair mean() const;

 private:
  float alpha_ = 1;
  int row_ = albedo_table::kRows - 4;  ///< first of the four rows used for interpolation
  float weight_[4] = {0, 0, 0, 1};     ///< weights of these rows
};

namespace albedo_table {
extern const float kTotal[kRows][kColumns];   ///< E at F = 1: a + b
extern const float kCosine[kRows][kColumns];  ///< m with b = E (1 - m (cos + alpha))^5
extern const float kMeanA[kRows], kMeanB[kRows];

/// Coordinates of rows and columns: position 0 is the first, 1 the last.
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
