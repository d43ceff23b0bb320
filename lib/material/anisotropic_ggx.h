// lib/material/anisotropic_ggx.h -- GGX with different widths along two axes, and its albedo from a table.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/sampling.h"
#include "lib/material/albedo.h"

namespace tempolux {

/// GGX with the width alpha_t along `grain` and alpha_b across it, alpha_t >= alpha_b. KHR_materials_anisotropy defines
/// alpha_b = roughness^2 and alpha_t = alpha_b + (1 - alpha_b) strength^2. The masking function
/// is that of Smith with correlated heights.
/// Visible normals are sampled as by Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
/// BasicGloss (opaque_lobes.h) takes this class as its width. Directions are in the local frame, z = normal.
class AnisotropicGgx {
 public:
  static constexpr bool kDirected = true;

  /// Widths are clamped to [kMinAlpha, 1]. grain: direction in the local frame, unit; its z component is left out.
  AnisotropicGgx(float alpha_t, float alpha_b, Vec3 grain);

  /// The albedo's parts F0 and F90 (albedo.h) for light from w.
  AlbedoPair albedo(Vec3 w) const;
  AlbedoPair mean_albedo() const;  ///< cosine-weighted mean over the hemisphere
  /// D(h) G2 / (4 cos_i cos_o) [1/sr] for the half vector h of wi and wo.
  float reflection(Vec3 wi, Vec3 wo, Vec3 h) const;
  /// Draws a visible normal for wo; u in [0, 1)^2.
  Vec3 sample_normal(Vec3 wo, Vec2 u) const;
  /// pdf [1/sr] of the direction that the half vector h reflects, if sample_normal draws h.
  float pdf_reflected(Vec3 h, Vec3 wo) const;
  void turn(const Frame& from, const Frame& to);  ///< expresses the grain in another local frame

 private:
  void set_grain(Vec3 grain);
  Vec3 along(Vec3 v) const { return {v.x * grain_.x + v.y * grain_.y, v.y * grain_.x - v.x * grain_.y, v.z}; }
  Vec3 back(Vec3 v) const { return {v.x * grain_.x - v.y * grain_.y, v.y * grain_.x + v.x * grain_.y, v.z}; }
  float distribution(Vec3 h) const;
  float smith_root(Vec3 w) const;

  float alpha_t_, alpha_b_;
  Vec2 grain_{1, 0};
  int row_[2];          ///< first of the four rows of each width
  float weight_[2][4];  ///< weights of these rows
};

namespace anisotropic_table {
inline constexpr int kRows = 10, kWidths = 10, kColumns = 14, kTurns = 9;
/// [0]: the albedo E at F = 1. [1]: m, from which follows b = E (1 - m (cos + alpha))^5 (albedo.h). alpha is the width
/// of GGX at the angle between the direction and the grain (alpha_at).
extern const float kAlbedo[kRows][kWidths][kColumns][kTurns][2];
extern const float kMean[kRows][kWidths][2];  ///< cosine-weighted means of E and b

/// Rows hold alpha_b as the rows of albedo.h do, columns the cosine as its columns at the width alpha. alpha_t of a
/// width, a position from 0 to 1:
inline double alpha_t_of(double alpha_b, double width) {
  const double first = std::pow(alpha_b, 0.25), root = first + width * (1 - first);
  return root * root * root * root;
}
/// Angle [rad] between the grain and the plane of the direction.
inline double angle_of(double turn) { return turn * 1.5707963267948966; }
/// Width alpha of GGX in the plane at this angle [rad] to the grain.
inline double alpha_at(double alpha_t, double alpha_b, double angle) {
  return std::hypot(alpha_t * std::cos(angle), alpha_b * std::sin(angle));
}
}  // namespace anisotropic_table

}  // namespace tempolux
