#include "lib/material/anisotropic_ggx.h"

#include "lib/material/cubic_weights.h"
#include "lib/material/ggx.h"

namespace tempolux {
namespace {

float fourth_root(float x) { return std::sqrt(std::sqrt(x)); }
/// Position in the table, from 0 to 1, of the width alpha; `first` is the width at 0, and 1 is the width at 1.
float position_between(float first, float alpha) {
  const float from = fourth_root(first);
  return from < 1 ? std::clamp((fourth_root(alpha) - from) / (1 - from), 0.0f, 1.0f) : 0;
}

}  // namespace

AnisotropicGgx::AnisotropicGgx(float alpha_t, float alpha_b, Vec3 grain)
    : alpha_t_(std::clamp(alpha_t, float(albedo_table::kMinAlpha), 1.0f)),
      alpha_b_(std::clamp(alpha_b, float(albedo_table::kMinAlpha), alpha_t_)) {
  set_grain(grain);
  row_[0] =
      cubic_weights(position_between(float(albedo_table::kMinAlpha), alpha_b_), anisotropic_table::kRows, weight_[0]);
  row_[1] = cubic_weights(position_between(alpha_b_, alpha_t_), anisotropic_table::kWidths, weight_[1]);
}

void AnisotropicGgx::set_grain(Vec3 grain) {
  const float length = std::hypot(grain.x, grain.y);
  grain_ = length > 0 ? Vec2{grain.x / length, grain.y / length} : Vec2{1, 0};
}

void AnisotropicGgx::turn(const Frame& from, const Frame& to) {
  set_grain(to.to_local(from.to_world({grain_.x, grain_.y, 0})));
}

AlbedoPair AnisotropicGgx::albedo(Vec3 w) const {
  const Vec3 v = along(w);
  const float cos = std::clamp(v.z, 0.0f, 1.0f);
  const float angle = v.x != 0 || v.y != 0 ? std::atan2(std::abs(v.y), std::abs(v.x)) : 0;
  const float c = std::cos(angle), s = std::sin(angle), alpha = std::hypot(alpha_t_ * c, alpha_b_ * s);
  float across[4], around[4];
  const int column =
      cubic_weights(std::sqrt(std::min(1.0f, cos * (1 + alpha) / (cos + alpha))), anisotropic_table::kColumns, across);
  const int first = cubic_weights(std::min(1.0f, angle * (2 * kInvPi)), anisotropic_table::kTurns, around);
  float total = 0, m = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const float weight = weight_[0][i] * weight_[1][j] * across[k];
        const float(*e)[2] = &anisotropic_table::kAlbedo[row_[0] + i][row_[1] + j][column + k][first];
        for (int l = 0; l < 4; ++l) total += weight * around[l] * e[l][0], m += weight * around[l] * e[l][1];
      }
  return albedo_table::split(total, m, cos + alpha);
}

AlbedoPair AnisotropicGgx::mean_albedo() const {
  float total = 0, b = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const float weight = weight_[0][i] * weight_[1][j];
      const float* mean = anisotropic_table::kMean[row_[0] + i][row_[1] + j];
      total += weight * mean[0], b += weight * mean[1];
    }
  return {total - b, b};
}

float AnisotropicGgx::distribution(Vec3 h) const {
  const Vec3 v = along(h);
  const float x = v.x / alpha_t_, y = v.y / alpha_b_;
  const float slope = std::max(1.0f, x * x + y * y + v.z * v.z);  // h = 0 if wi = -wo
  return kInvPi / (alpha_t_ * alpha_b_ * slope * slope);
}

/// sqrt(cos^2 + (alpha_t x)^2 + (alpha_b y)^2): Smith's Lambda is (root / cos - 1) / 2.
float AnisotropicGgx::smith_root(Vec3 w) const {
  const Vec3 v = along(w);
  const float x = alpha_t_ * v.x, y = alpha_b_ * v.y;
  return std::sqrt(v.z * v.z + x * x + y * y);
}

float AnisotropicGgx::reflection(Vec3 wi, Vec3 wo, Vec3 h) const {
  return distribution(h) * 0.5f / std::max(1e-20f, wo.z * smith_root(wi) + wi.z * smith_root(wo));
}

Vec3 AnisotropicGgx::sample_normal(Vec3 wo, Vec2 u) const {
  return back(ggx::sample_visible_normal(along(wo), alpha_t_, alpha_b_, u));
}

float AnisotropicGgx::pdf_reflected(Vec3 h, Vec3 wo) const { return distribution(h) * 0.5f / (wo.z + smith_root(wo)); }

}  // namespace tempolux
