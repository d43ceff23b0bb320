#include "lib/material/rough_glass.h"

#include <algorithm>
#include <cmath>

#include "lib/core/sampling.h"
#include "lib/material/dielectric.h"
#include "lib/material/ggx.h"

namespace tempolux {
namespace {

/// Mean over the hemisphere outside of the Fresnel term for the index n >= 1 [1]: the fit of Kulla & Conty 2017.
float mean_fresnel(float n) { return (n - 1) / (4.08567f + 1.00071f * n); }

}  // namespace

RoughGlass::RoughGlass(float index, float alpha, bool thin, bool outside)
    : loss_(index, alpha),
      wall_(alpha),
      alpha_(alpha),
      alpha2_(alpha * alpha),
      eta_(thin || outside ? 1 / index : index),
      thin_(thin),
      side_(thin || outside ? 0 : 1) {
  const float through = 1 - std::min(1.0f, mean_fresnel(index));
  if (thin) {
    share_behind_ = through;
  } else {
    const float ratio = loss_.mean(0) / (loss_.mean(1) * index * index);  // d / b
    const float b = std::min(through, through > 0 ? 1 / std::max(1.0f, ratio) : 0.0f);
    share_behind_ = side_ == 0 ? b : b * ratio;
  }
  // 1 - E is about in proportion to 1 / (cos^2 + alpha^2), so directions of f_ms are drawn in proportion to this.
  spread2_ = std::max(alpha2_, 1e-6f);
  log_spread_ = std::log1p(1 / spread2_);
}

/// 1 - E for cos_theta on wo's side, or with `behind` on the other side.
float RoughGlass::loss(bool behind, float cos_theta) const {
  if (!thin_) return loss_.at(behind ? 1 - side_ : side_, cos_theta);
  const AlbedoPair e = wall_.at(cos_theta);
  return std::max(0.0f, 1 - (e.a + e.b));
}

float RoughGlass::mean_loss(bool behind) const {
  if (!thin_) return loss_.mean(behind ? 1 - side_ : side_);
  const AlbedoPair e = wall_.mean();
  return std::max(1e-7f, 1 - (e.a + e.b));
}

/// pdf [1/sr] of a direction on one side that sample() draws for f_ms: cos_i = sqrt(spread^2 ((1 + 1/spread^2)^u - 1))
/// for u in [0, 1), with uniform azimuth.
float RoughGlass::multiple_pdf_solid_angle(float cos_i) const {
  return cos_i * kInvPi / ((cos_i * cos_i + spread2_) * log_spread_);
}

RoughGlass::Pair RoughGlass::single(Vec3 wi, Vec3 wo) const {
  const float cos_i = std::abs(wi.z);
  const bool behind = wi.z < 0;
  float cos_t;
  if (!behind || thin_) {
    const Vec3 h = normalize(Vec3{wi.x, wi.y, cos_i} + wo);
    const float reflectance = fresnel_dielectric(std::clamp(dot(wo, h), 0.0f, 1.0f), eta_, cos_t);
    const float share = behind ? 1 - reflectance : reflectance;
    return {share * ggx::distribution(h, alpha2_) * ggx::visibility(cos_i, wo.z, alpha2_),
            share * ggx::pdf_reflected(h, wo.z, alpha2_)};
  }
  Vec3 h = wi + wo * eta_;
  const float size = length(h);
  if (!(size > 0)) return {};
  h = h * ((h.z < 0 ? -1 : 1) / size);
  const float cos_oh = dot(wo, h), cos_ih = dot(wi, h);
  if (!(cos_oh > 0) || !(cos_ih < 0)) return {};
  const float share = 1 - fresnel_dielectric(std::min(1.0f, cos_oh), eta_, cos_t);
  const float slope = cos_ih + eta_ * cos_oh, turned = -cos_ih / std::max(1e-20f, slope * slope);  // dh / dwi
  const float d = share * ggx::distribution(h, alpha2_) * cos_oh * turned;
  return {4 * d * ggx::visibility(cos_i, wo.z, alpha2_), 4 * d * 0.5f / (wo.z + ggx::smith_root(wo.z, alpha2_))};
}

float RoughGlass::eval(Vec3 wi, Vec3 wo) const {
  const bool behind = wi.z < 0;
  const float share = behind ? share_behind_ : 1 - share_behind_;
  return single(wi, wo).f + share * kInvPi * loss(behind, std::abs(wi.z)) * loss(false, wo.z) / mean_loss(behind);
}

float RoughGlass::pdf_solid_angle(Vec3 wi, Vec3 wo) const {
  const float several = loss(false, wo.z), share = wi.z < 0 ? share_behind_ : 1 - share_behind_;
  return (1 - several) * single(wi, wo).pdf_solid_angle + several * share * multiple_pdf_solid_angle(std::abs(wi.z));
}

Vec3 RoughGlass::sample(Vec3 wo, float u_lobe, Vec2 u) const {
  const float several = loss(false, wo.z);
  if (u_lobe < several) {
    const float cos = std::sqrt(std::min(1.0f, spread2_ * std::expm1(u.y * log_spread_)));
    const float sin = std::sqrt(std::max(0.0f, 1 - cos * cos)), phi = 2 * kPi * u.x;
    return {sin * std::cos(phi), sin * std::sin(phi), u_lobe < several * share_behind_ ? -cos : cos};
  }
  u_lobe = (u_lobe - several) / (1 - several);
  const Vec3 h = ggx::sample_visible_normal(wo, alpha_, alpha_, u);
  const float cos_oh = std::clamp(dot(wo, h), 0.0f, 1.0f);
  float cos_t;
  if (u_lobe < fresnel_dielectric(cos_oh, eta_, cos_t)) {
    const Vec3 wi = normalize(h * (2 * cos_oh) - wo);
    return wi.z > 0 ? wi : Vec3{};
  }
  if (thin_) {
    const Vec3 wi = normalize(h * (2 * cos_oh) - wo);
    return wi.z > 0 ? Vec3{wi.x, wi.y, -wi.z} : Vec3{};
  }
  const Vec3 wi = normalize(h * (eta_ * cos_oh - cos_t) - wo * eta_);
  return wi.z < 0 ? wi : Vec3{};
}

}  // namespace tempolux
