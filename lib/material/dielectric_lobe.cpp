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
  if (material.iridescence > 0 && !rough_) [[unlikely]]
    film_.emplace(Schlick{Rgb(normal_reflectance(ior)), 1}, material.iridescence, material.iridescence_ior,
                  material.iridescence_thickness_maximum);
}

/// Reflectance [1] of one face, with its film, for light of cosine cos_o > 0. cos_t receives the cosine on the other
/// side, as in fresnel_dielectric().
Rgb DielectricLobe::reflectance_of_face(float cos_o, float& cos_t) const {
  const float f = fresnel_dielectric(cos_o, eta_reflected_, cos_t);
  if (!film_ || !(f < 1)) return Rgb(f);
  return film_->at(eta_reflected_ > 1 ? cos_t : cos_o);  // the cosine outside
}

/// Shares of light [1] at a plate, or at a boundary with a film: the share that is reflected towards a direction of
/// cosine cos_o > 0, and the share that is transmitted towards this direction.
DielectricLobe::Shares DielectricLobe::shares(float cos_o, float& cos_t) const {
  if (plate_ && !plate_->outer) return {Rgb(0.0f), tint_};
  const Rgb face = reflectance_of_face(cos_o, cos_t);
  Shares shares{face, Rgb(0.0f)};
  if (!(cos_t > 0)) return shares;
  for (int k = 0; k < 3; ++k) {
    const float f = face[k];
    if (!plate_) {
      shares.passed[k] = tint_[k] * (1 - f);
      continue;
    }
    const float a = std::pow(plate_->across[k], 1 / std::abs(cos_t));
    const float once = (1 - f) * (1 - f) * a / (1 - f * f * a * a);
    shares.passed[k] = tint_[k] * once;
    shares.reflected[k] += tint_[k] * tint_[k] * once * f * a;
  }
  return shares;
}

float DielectricLobe::reflectance(float cos_o) const {
  float cos_t;
  if (plate_ || film_) return shares(cos_o, cos_t).chance();
  return fresnel_dielectric(cos_o, eta_reflected_, cos_t);
}

Rgb DielectricLobe::passed_straight(float cos_o) const {
  float cos_t;
  if (plate_ || (film_ && pane_)) return shares(cos_o, cos_t).passed * share_;
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
  if (plate_ || film_) {
    sample_by_channel(wo, u_lobe, s);
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

/// Draws reflection or transmission where the channels have different shares.
void DielectricLobe::sample_by_channel(Vec3 wo, float u_lobe, LobeSample& s) const {
  float cos_t = 0;
  const Shares by_channel = shares(wo.z, cos_t);
  const float reflected = by_channel.chance();
  s.delta = true;
  s.transmitted = !(u_lobe < reflected);
  s.straight = s.transmitted && (plate_ || pane_);
  const bool turned = s.transmitted && !s.straight && eta_ != 1;
  s.wi = !s.transmitted ? Vec3{-wo.x, -wo.y, wo.z} : turned ? refract(wo, eta_, cos_t) : -wo;
  const float p = s.transmitted ? 1 - reflected : reflected;
  s.weight = (s.transmitted ? by_channel.passed : by_channel.reflected) * (1 / p);
  s.pdf_solid_angle = share_ * p;
}

}  // namespace tempolux
