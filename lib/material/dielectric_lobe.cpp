#include "lib/material/dielectric_lobe.h"

#include "lib/material/dielectric.h"
#include "lib/material/inside.h"

namespace tempolux {

DielectricLobe::DielectricLobe(const MaterialValues& material, bool front, float plate)
    : share_(material.transmission * (1 - material.metallic)), tint_(material.base_color) {
  const bool thin = material.thin_walled;
  const float ior = material.ior > 0 ? material.ior : 1e4f;  // KHR_materials_ior: ior 0 reflects everything
  eta_reflected_ = thin || front ? 1 / ior : ior;
  eta_ = thin ? 1 : eta_reflected_;
  // If the index is close to 1, light is hardly refracted, and the lobe may be narrower than float32 resolves. Such a
  // boundary counts as smooth.
  const float alpha = material.roughness * material.roughness;
  if (material.roughness >= kMirrorRoughness && (thin || alpha * (ior - 1) > 2e-5f)) {
    rough_.emplace(ior, alpha, thin, front);
    light_share_behind_ = thin ? 0.5f : front ? 0.0f : 1.0f;
  }
  pane_ = thin && !rough_;
  if (plate > 0 && !rough_) plate_ = Plate{front, transmittance(material, plate)};
}

/// The shares that a plate reflects towards cos_o > 0 and lets pass towards it.
DielectricLobe::Shares DielectricLobe::plate_shares(float cos_o) const {
  if (!plate_->outer) return {Rgb(0.0f), tint_};
  float cos_t;
  const float f = fresnel_dielectric(cos_o, eta_reflected_, cos_t);
  Shares shares{Rgb(f), Rgb(0.0f)};
  if (!(f < 1)) return shares;
  for (int k = 0; k < 3; ++k) {
    const float a = std::pow(plate_->across[k], 1 / std::abs(cos_t));
    const float once = (1 - f) * (1 - f) * a / (1 - f * f * a * a);
    shares.passed[k] = tint_[k] * once;
    shares.reflected[k] += tint_[k] * tint_[k] * once * f * a;
  }
  return shares;
}

float DielectricLobe::reflectance(float cos_o) const {
  if (plate_) return plate_shares(cos_o).chance();
  float cos_t;
  return fresnel_dielectric(cos_o, eta_reflected_, cos_t);
}

Rgb DielectricLobe::passed_straight(float cos_o) const {
  if (plate_) return plate_shares(cos_o).passed * share_;
  return pane_ ? tint_ * (share_ * (1 - reflectance(cos_o))) : Rgb(0.0f);
}

Rgb DielectricLobe::eval(Vec3 wi, Vec3 wo) const {
  if (!rough_ || wi.z == 0) return Rgb(0.0f);
  const float f = share_ * rough_->eval(wi, wo);
  return wi.z < 0 ? tint_ * f : Rgb(f);
}

void DielectricLobe::sample(Vec3 wo, float u_lobe, Vec2 u, LobeSample& s) const {
  if (rough_) {
    s.wi = rough_->sample(wo, u_lobe, u);
    s.transmitted = s.wi.z < 0;
    return;
  }
  if (plate_) {
    sample_plate(wo, u_lobe, s);
    return;
  }
  float cos_t = 0;
  const float reflected = fresnel_dielectric(wo.z, eta_reflected_, cos_t);
  s.delta = true;
  s.transmitted = !(u_lobe < reflected);
  if (s.transmitted) {
    s.straight = pane_;
    s.wi = eta_ == 1 ? -wo : refract(wo, eta_, cos_t);
    s.weight = tint_;
    s.pdf_solid_angle = share_ * (1 - reflected);
  } else {
    s.wi = {-wo.x, -wo.y, wo.z};
    s.weight = Rgb(1.0f);
    s.pdf_solid_angle = share_ * reflected;
  }
}

void DielectricLobe::sample_plate(Vec3 wo, float u_lobe, LobeSample& s) const {
  const Shares shares = plate_shares(wo.z);
  const float reflected = shares.chance();
  s.delta = true;
  s.transmitted = s.straight = !(u_lobe < reflected);
  s.wi = s.transmitted ? -wo : Vec3{-wo.x, -wo.y, wo.z};
  const float p = s.transmitted ? 1 - reflected : reflected;
  s.weight = (s.transmitted ? shares.passed : shares.reflected) * (1 / p);
  s.pdf_solid_angle = share_ * p;
}

}  // namespace tempolux
