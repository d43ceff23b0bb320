#include "lib/material/bsdf.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/core/sampling.h"
#include "lib/material/dielectric.h"
#include "lib/material/ggx.h"

namespace tempolux {
namespace {

float power5(float x) { return x * x * x * x * x; }
float smooth_step(float x) {
  x = std::clamp(x, 0.0f, 1.0f);
  return x * x * (3 - 2 * x);
}
/// If GGX loses less than this share of light on average, f_ms is dropped: it would be concentrated at grazing angles,
/// and its cosine-distributed samples would have weights of more than ten times their mean. Between this loss and three
/// times this loss f_ms is faded in.
constexpr float kLeastLost = 0.01f;

/// Schlick's Fresnel term, F0 + (F90 - F0) (1 - cos_h)^5 [1]. Schlick, "An Inexpensive BRDF Model for
/// Physically-based Rendering", CGF 13(3), 1994.
Rgb fresnel(Rgb f0, float f90, float cos_h) {
  const float k = power5(std::clamp(1 - cos_h, 0.0f, 1.0f));
  return f0 * (1 - k) + Rgb(f90 * k);
}

/// F0 [1] of a dielectric in glTF: ((ior - 1) / (ior + 1))^2 times KHR_materials_specular's colour, at most 1, times
/// its factor.
Rgb dielectric_f0(const MaterialValues& m) {
  const float r = (m.ior - 1) / (m.ior + 1), f = r * r;
  return Rgb{std::min(1.0f, f * m.specular_color.r), std::min(1.0f, f * m.specular_color.g),
             std::min(1.0f, f * m.specular_color.b)} *
         m.specular;
}

}  // namespace

Bsdf::Bsdf(const MaterialValues& material, bool front) {
  if (material.unlit) return;  // scatters nothing
  const float metallic = material.metallic;
  transmission_ = material.transmission * (1 - metallic);
  if (transmission_ > 0) {
    const float ior = material.ior > 0 ? material.ior : 1e4f;  // KHR_materials_ior: ior 0 reflects everything
    transmission_tint_ = material.base_color;
    eta_reflected_ = material.thin_walled || front ? 1 / ior : ior;
    eta_ = material.thin_walled ? 1 : eta_reflected_;
    // If the index is close to 1, light is hardly refracted, and the lobe may be narrower than float32 resolves. Such a
    // boundary counts as smooth.
    const float alpha = material.roughness * material.roughness;
    if (material.roughness >= kMirrorRoughness && (material.thin_walled || alpha * (ior - 1) > 2e-5f)) {
      rough_.emplace(ior, alpha, material.thin_walled, front);
      light_share_behind_ = material.thin_walled ? 0.5f : front ? 0.0f : 1.0f;
    }
    pane_ = material.thin_walled && !rough_;
    if (transmission_ >= 1) return;
  }
  rho_ = material.base_color * (1 - metallic);
  lambert_ = metallic < 1;
  diffuse_ = max_component(rho_) > 0;
  f90_ = material.specular * (1 - metallic) + metallic;
  if (!(f90_ > 0)) return;  // specular = metallic = 0: matte, and F0 is 0 as well
  specular_ = true;
  f0_ = dielectric_f0(material) * (1 - metallic) + material.base_color * metallic;
  f0_max_ = max_component(f0_);
  delta_ = material.roughness < kMirrorRoughness;
  if (delta_) {
    mean_albedo_ = (20 * f0_max_ + f90_) / 21;
  } else {
    alpha_ = material.roughness * material.roughness;
    alpha2_ = alpha_ * alpha_;
    albedo_ = GgxAlbedo(alpha_);
    const AlbedoPair m = albedo_.mean();
    const float e = m.a + m.b, lost = 1 - e;
    mean_lost_ = lost;
    if (const float fade = smooth_step((lost - kLeastLost) / (2 * kLeastLost)); fade > 0) {
      for (int c = 0; c < 3; ++c) {
        const float f = (20 * f0_[c] + f90_) / 21;
        multiple_[c] = fade * f * f * e / (1 - f * lost) / lost;
      }
    }
    mean_albedo_ = f0_max_ * m.a + f90_ * m.b + max_component(multiple_) * lost * lost;
  }
  // If f_S reflects all light, the Lambert lobe receives none.
  const float rest = 1 - mean_albedo_;
  if (rest > 1e-6f) coupling_scale_ = 1 / std::sqrt(rest);
  else diffuse_ = false;
}

Bsdf::Reflection Bsdf::reflection(float cos_theta) const {
  Reflection r;
  if (!specular_) return r;
  AlbedoPair e;
  if (delta_) {
    e.b = power5(std::clamp(1 - cos_theta, 0.0f, 1.0f));
    e.a = 1 - e.b;
  } else {
    e = albedo_.at(cos_theta);
    r.lost = std::max(0.0f, 1 - (e.a + e.b));
  }
  r.single = f0_ * e.a + Rgb(f90_ * e.b);
  r.multiple = multiple_ * (mean_lost_ * r.lost);
  return r;
}

Rgb Bsdf::specular_albedo(float cos_o) const {
  const Reflection r = reflection(cos_o);
  return r.single + r.multiple;
}

Rgb Bsdf::passed_straight(float cos_o) const {
  if (!pane_ || !(cos_o > 0)) return Rgb(0.0f);
  float cos_t;
  return transmission_tint_ * (transmission_ * (1 - fresnel_dielectric(cos_o, eta_reflected_, cos_t)));
}

/// c(w); 1 without a reflection above the Lambert lobe.
float Bsdf::coupling(const Reflection& r) const {
  return specular_ ? std::max(0.0f, 1 - max_component(r.single + r.multiple)) * coupling_scale_ : 1;
}

float Bsdf::diffuse_coupling(float cos_theta) const { return specular_ ? coupling(reflection(cos_theta)) : 1; }

Rgb Bsdf::diffuse_reflectance(float cos_o) const {
  return (specular_ ? rho_ * (diffuse_coupling(cos_o) / coupling_scale_) : rho_) * (1 - transmission_);
}

float Bsdf::arrival_weight(float cos_i) const { return diffuse_coupling(cos_i) * coupling_scale_; }

/// P(D): the Lambert lobe's share of the uniform light that all lobes together reflect towards wo.
float Bsdf::diffuse_probability(const Reflection& r) const {
  if (!diffuse_) return 0;
  if (!specular_) return 1;
  const Rgb s = r.single + r.multiple;
  const float d = channel_mean(rho_) * std::max(0.0f, 1 - max_component(s)), total = d + channel_mean(s);
  return total > 0 ? d / total : 0;
}

Rgb Bsdf::eval_diffuse(const Direction& wi, const Direction& wo) const {
  if (!diffuse_ || !(wi.w.z > 0) || !(wo.w.z > 0)) return Rgb(0.0f);
  if (!specular_) return rho_ * (kInvPi * (1 - transmission_));
  return rho_ * (kInvPi * coupling(wi.reflected) * coupling(wo.reflected) * (1 - transmission_));
}

Rgb Bsdf::specular(Vec3 wi, Vec3 wo, float lost_i, float lost_o) const {
  const Vec3 h = normalize(wi + wo);
  const float d = ggx::distribution(h, alpha2_) * ggx::visibility(wi.z, wo.z, alpha2_);
  return fresnel(f0_, f90_, dot(wo, h)) * d + multiple_ * (kInvPi * lost_i * lost_o);
}

Rgb Bsdf::eval_opaque(const Direction& wi, const Direction& wo) const {
  if (!specular_ || delta_ || !(wi.w.z > 0) || !(wo.w.z > 0)) return Rgb(0.0f);
  return specular(wi.w, wo.w, wi.reflected.lost, wo.reflected.lost) * (1 - transmission_);
}

Rgb Bsdf::eval_rough(Vec3 wi, Vec3 wo) const {
  if (wi.z == 0 || !(wo.z > 0)) return Rgb(0.0f);
  const float f = transmission_ * rough_->eval(wi, wo);
  return wi.z < 0 ? transmission_tint_ * f : Rgb(f);
}

Rgb Bsdf::eval_specular(const Direction& wi, const Direction& wo) const {
  return rough_ ? eval_opaque(wi, wo) + eval_rough(wi.w, wo.w) : eval_opaque(wi, wo);
}

bool Bsdf::draws_diffuse(const Direction& wo, float u_lobe) const {
  if (!diffuse_ || !(wo.w.z > 0)) return false;
  if (transmission_ > 0) {
    if (u_lobe < transmission_) return false;
    u_lobe = std::min(kOneMinusEpsilon, (u_lobe - transmission_) / (1 - transmission_));
  }
  return u_lobe < diffuse_probability(wo.reflected);
}

float Bsdf::pdf_diffuse(Vec3 wi, const Direction& wo) const {
  if (!diffuse_ || !(wi.z > 0) || !(wo.w.z > 0)) return 0;
  return diffuse_probability(wo.reflected) * pdf_hemisphere_cos(wi.z) * (1 - transmission_);
}

/// The share of event S's light that several microfacets reflect. [1]
float Bsdf::multiple_share(const Reflection& r) {
  const float multiple = channel_mean(r.multiple), total = multiple + channel_mean(r.single);
  return total > 0 ? multiple / total : 0;
}

/// pdf of event S [1/sr] without P(S): visible normals for single reflection, the cosine for multiple reflection.
float Bsdf::pdf_given_specular(Vec3 wi, Vec3 wo, const Reflection& r) const {
  const float share = multiple_share(r);
  return (1 - share) * ggx::pdf_reflected(normalize(wi + wo), wo.z, alpha2_) + share * pdf_hemisphere_cos(wi.z);
}

float Bsdf::gloss_density(Vec3 wi, const Direction& wo) const {
  const bool gloss = specular_ && !delta_ && !(transmission_ > 0) && wi.z > 0 && wo.w.z > 0;
  return gloss ? pdf_given_specular(wi, wo.w, wo.reflected) : std::numeric_limits<float>::infinity();
}

float Bsdf::pdf_specular(Vec3 wi, const Direction& wo) const {
  float pdf = rough_ && wi.z != 0 && wo.w.z > 0 ? transmission_ * rough_->pdf(wi, wo.w) : 0;
  if (!specular_ || delta_ || !(wi.z > 0) || !(wo.w.z > 0)) return pdf;
  return pdf +
         (1 - diffuse_probability(wo.reflected)) * pdf_given_specular(wi, wo.w, wo.reflected) * (1 - transmission_);
}

void Bsdf::sample_diffuse(Vec3 wo, Vec2 u, const Reflection& r, Sample& s) const {
  const float p = diffuse_probability(r);
  s.diffuse = true;
  s.wi = sample_hemisphere_cos(u);
  s.pdf_solid_angle = p * pdf_hemisphere_cos(s.wi.z);
  s.weight = rho_;  // f_D cos / pdf_D; c = 1
  if (!specular_) return;
  s.weight *= diffuse_coupling(s.wi.z) * coupling(r) / p;
  if (!delta_) s.pdf_solid_angle += (1 - p) * pdf_given_specular(s.wi, wo, r);
}

void Bsdf::sample_specular(Vec3 wo, float u_lobe, Vec2 u, const Reflection& r, Sample& s) const {
  const float p = 1 - diffuse_probability(r);
  if (delta_) {
    s.delta = true;
    s.wi = {-wo.x, -wo.y, wo.z};
    s.weight = r.single / p;
    s.pdf_solid_angle = p;
    return;
  }
  const float share = multiple_share(r);
  if (u_lobe < share) {
    s.wi = sample_hemisphere_cos(u);
  } else {
    const Vec3 h = ggx::sample_visible_normal(wo, alpha_, u);
    s.wi = normalize(h * (2 * dot(wo, h)) - wo);
  }
  if (!(s.wi.z > 0)) return;  // reflected into the surface: absorbed
  const float pdf = p * pdf_given_specular(s.wi, wo, r);
  s.weight = specular(s.wi, wo, reflection(s.wi.z).lost, r.lost) * (s.wi.z / pdf);
  s.pdf_solid_angle = pdf + (1 - p) * pdf_hemisphere_cos(s.wi.z);
}

void Bsdf::sample_dielectric(Vec3 wo, float u_lobe, Sample& s) const {
  float cos_t = 0;
  const float reflectance = fresnel_dielectric(wo.z, eta_reflected_, cos_t);
  s.delta = true;
  s.weight = Rgb(1.0f);
  if (u_lobe < reflectance) {
    s.wi = {-wo.x, -wo.y, wo.z};
    s.pdf_solid_angle = transmission_ * reflectance;
    return;
  }
  s.transmitted = true;
  s.straight = pane_;
  s.wi = eta_ == 1 ? -wo : refract(wo, eta_, cos_t);
  s.weight = transmission_tint_;
  s.pdf_solid_angle = transmission_ * (1 - reflectance);
}

float Bsdf::fork_probability(const Direction& wo) const {
  if (!(wo.w.z > 0)) return 1;
  float cos_t;
  return transmission_ > 0 ? fresnel_dielectric(wo.w.z, eta_reflected_, cos_t) : diffuse_probability(wo.reflected);
}

void Bsdf::sample_rough(const Direction& wo, float u_lobe, Vec2 u, Sample& s) const {
  s.wi = rough_->sample(wo.w, u_lobe, u);
  if (s.wi.z == 0) return;  // lost at the wrong side of the surface
  s.transmitted = s.wi.z < 0;
  const float pdf = pdf_specular(s.wi, wo);
  if (!(pdf > 0)) return;
  s.weight = eval_specular(along(s.wi), wo) * (std::abs(s.wi.z) / pdf);
  s.pdf_solid_angle = pdf + pdf_diffuse(s.wi, wo);
}

Bsdf::Sample Bsdf::sample(const Direction& wo, float u_lobe, Vec2 u) const {
  if (!(transmission_ > 0)) return sample_opaque(wo, u_lobe, u);
  Sample s;
  if (!(wo.w.z > 0)) return s;
  if (u_lobe < transmission_) {
    if (rough_) {
      sample_rough(wo, u_lobe / transmission_, u, s);
      return s;
    }
    sample_dielectric(wo.w, u_lobe / transmission_, s);
    return s;
  }
  s = sample_opaque(wo, std::min(kOneMinusEpsilon, (u_lobe - transmission_) / (1 - transmission_)), u);
  s.pdf_solid_angle *= 1 - transmission_;
  if (rough_ && !s.diffuse && s.pdf_solid_angle > 0) {  // the lobes of event S overlap
    const float pdf = pdf_specular(s.wi, wo);
    s.weight = pdf > 0 ? eval_specular(along(s.wi), wo) * (s.wi.z / pdf) : Rgb(0.0f);
    s.pdf_solid_angle = pdf + pdf_diffuse(s.wi, wo);
  } else if (rough_ && s.diffuse) {
    s.pdf_solid_angle += transmission_ * rough_->pdf(s.wi, wo.w);
  }
  return s;
}

Bsdf::Sample Bsdf::sample_opaque(const Direction& wo, float u_lobe, Vec2 u) const {
  Sample s;
  if (!(wo.w.z > 0)) return s;
  const Reflection& r = wo.reflected;
  const float p = diffuse_probability(r);
  if (u_lobe < p) sample_diffuse(wo.w, u, r, s);
  else if (specular_ && max_component(r.single) > 0) sample_specular(wo.w, (u_lobe - p) / (1 - p), u, r, s);
  return s;
}

}  // namespace tempolux
