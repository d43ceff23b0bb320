// lib/material/sheen.h -- the sheen of cloth: fibres that stand up and shine at grazing angles.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/material/lobe.h"

namespace tempolux {

/// D V [1/sr] of KHR_materials_sheen, the lobe of Estevez & Kulla, "Production Friendly Microfacet Sheen BRDF", 2017:
///     D = (2 + 1/alpha) sin_h^(1/alpha) / (2 pi),   V = 1 / (4 cos_i cos_o (1 + Lambda(cos_i) + Lambda(cos_o))),
/// with their fit of Lambda, exp(L(cos)) below cos = 1/2 and exp(2 L(1/2) - L(1 - cos)) above. alpha = roughness^2;
/// cosines above 0; sin2_h: squared sine of the half vector's angle.
template <class Real>
Real sheen_formula(Real cos_i, Real cos_o, Real sin2_h, Real alpha) {
  const auto lambda = [m = (1 - alpha) * (1 - alpha)](Real cos) {
    const auto mix = [m](double rough, double smooth) { return Real(rough) + (Real(smooth) - Real(rough)) * m; };
    const auto l = [&](Real x) {
      return mix(21.5473, 25.3245) / (1 + mix(3.82987, 3.32435) * std::pow(x, mix(0.19823, 0.16801))) +
             mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967);
    };
    return std::exp(cos < Real(0.5) ? l(cos) : 2 * l(Real(0.5)) - l(std::max(Real(0), 1 - cos)));
  };
  const Real d = (2 + 1 / alpha) * std::pow(std::max(Real(0), sin2_h), Real(0.5) / alpha) * Real(0.15915494309189535);
  return d / (4 * cos_i * cos_o * (1 + lambda(cos_i) + lambda(cos_o)));
}

/// KHR_materials_sheen, with the functions of lobe.h:
///     f = sheen_color D V / N(wi, wo),   N = max(1, E(wi), E(wo)),   E(w) = integral of D V cos.
/// Below a roughness of .25, D V reflects more light than arrives at grazing angles: E is up to 3. N keeps the lobe
/// reciprocal and its albedo at most 1; for other roughnesses it is 1, and f is that of the specification. Both E and
/// the albedo for N come from a table. Roughness below kLeastRoughness is raised to kLeastRoughness, since a narrower
/// lobe lights only a line.
class Sheen {
 public:
  static constexpr bool kDelta = false;
  static constexpr float kLeastRoughness = 0.07f;

  Sheen(Rgb color, float roughness, float share);
  float mean_kept() const { return max_component(color_) * mean_; }
  /// `lost` holds max(1, E(w)).
  LobeAlbedo albedo(Vec3 w) const;
  Rgb eval(LobeDirection wi, LobeDirection wo) const;
  float pdf_solid_angle(Vec3 wi, LobeDirection) const { return wi.z > 0 ? kUniform : 0; }
  void sample(LobeDirection wo, float u_lobe, Vec2 u, LobeSample& s) const;
  Rgb weight(LobeDirection wi, LobeDirection wo, float chance, float pdf) const;

 private:
  static constexpr float kUniform = 0.15915494f;  ///< 1 / (2 pi): samples are uniform over the hemisphere
  float f(LobeDirection wi, LobeDirection wo) const;

  Rgb color_;
  float share_, alpha_, mean_;
  int row_;          ///< first of the four rows of the table used for interpolation
  float weight_[4];  ///< weights of these rows
};

namespace sheen_table {
inline constexpr int kRows = 32, kColumns = 40;
extern const float kAlbedo[kRows][kColumns][2];  ///< the albedo for white, E
extern const float kMean[kRows];                 ///< cosine-weighted mean of the albedo

/// roughness and cosine of a position in the table: 0 is the first row or column, 1 the last.
inline double roughness_of_row(double position) {
  return double(Sheen::kLeastRoughness) + position * (1 - double(Sheen::kLeastRoughness));
}
inline double cos_of_column(double position) { return std::max(1e-5, position * position * position); }
}  // namespace sheen_table

}  // namespace tempolux
