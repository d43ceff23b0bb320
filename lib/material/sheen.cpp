#include "lib/material/sheen.h"

#include "lib/core/sampling.h"
#include "lib/material/cubic_weights.h"

namespace tempolux {

Sheen::Sheen(Rgb color, float roughness, float share) : color_(color), share_(share), mean_(0) {
  const float r = std::clamp(roughness, kLeastRoughness, 1.0f);
  alpha_ = r * r;
  row_ = cubic_weights((r - kLeastRoughness) / (1 - kLeastRoughness), sheen_table::kRows, weight_);
  for (int i = 0; i < 4; ++i) mean_ += weight_[i] * sheen_table::kMean[row_ + i];
}

LobeAlbedo Sheen::albedo(Vec3 w) const {
  float across[4];
  const int column = cubic_weights(std::cbrt(std::clamp(w.z, 0.0f, 1.0f)), sheen_table::kColumns, across);
  float albedo = 0, raw = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const float* e = sheen_table::kAlbedo[row_ + i][column + j];
      albedo += weight_[i] * across[j] * e[0], raw += weight_[i] * across[j] * e[1];
    }
  LobeAlbedo found{.single = color_ * std::clamp(albedo, 0.0f, 1.0f), .lost = std::max(1.0f, raw)};
  found.keep_largest();
  return found;
}

/// f [1/sr] for white, without share and coupling.
float Sheen::f(LobeDirection wi, LobeDirection wo) const {
  const Vec3 h = wi.w + wo.w;
  const float across = h.x * h.x + h.y * h.y, sin2 = across / (across + h.z * h.z);
  constexpr float kGrazing = 1e-5f;  // the first column of the table
  return sheen_formula(std::max(kGrazing, wi.w.z), std::max(kGrazing, wo.w.z), sin2, alpha_) /
         std::max(wi.albedo.lost, wo.albedo.lost);
}

Rgb Sheen::eval(LobeDirection wi, LobeDirection wo) const {
  return color_ * (f(wi, wo) * passed_both(wi, wo) * share_);
}

void Sheen::sample(LobeDirection wo, float, Vec2 u, LobeSample& s) const {
  if (!(max_component(wo.albedo.single) > 0)) return;
  const float r = std::sqrt(std::max(0.0f, 1 - u.y * u.y)), phi = 2 * kPi * u.x;
  s.wi = {r * std::cos(phi), r * std::sin(phi), u.y};
  if (s.wi.z > 0) s.pdf_solid_angle = kUniform;
}

Rgb Sheen::weight(LobeDirection wi, LobeDirection wo, float, float pdf) const {
  return color_ * (f(wi, wo) * passed_both(wi, wo) * (wi.w.z / pdf));
}

}  // namespace tempolux
