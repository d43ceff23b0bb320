// lib/material/bsdf_lobes.cpp -- makes the lobes of a Bsdf from a material.
#include <cmath>

#include "lib/material/bsdf.h"
#include "lib/material/dielectric.h"

namespace tempolux {
namespace {

/// F0 [1] of a dielectric in glTF: normal_reflectance(ior) times KHR_materials_specular's colour, at most 1, times its
/// factor.
Rgb dielectric_f0(const MaterialValues& m) {
  const float f = normal_reflectance(m.ior);
  return Rgb{std::min(1.0f, f * m.specular_color.r), std::min(1.0f, f * m.specular_color.g),
             std::min(1.0f, f * m.specular_color.b)} *
         m.specular;
}

PartMetal part_metal(const MaterialValues& m) {
  return {Schlick{dielectric_f0(m), m.specular}, Schlick{m.base_color, 1}, m.metallic};
}

}  // namespace

// Here a material becomes lobes: those of event S from the top down, then the Lambert lobe.
Bsdf::Bsdf(const MaterialValues& material, bool front, const Frame* frame, Carries carries, float plate) {
  if (material.unlit) return;  // scatters nothing
  const float metallic = material.metallic;
  far_side_ = material.from_far_side;
  if (!far_side_ && material.transmission * (1 - metallic) > 0) {
    glass_.emplace(material, front, plate);
    rest_ = 1 - glass_->share();
    if (!glass_->is_delta()) ++spread_;
    if (!(rest_ > 0)) return;
  }
  has_lambert_ = metallic < 1;
  const Rgb sheen = material.sheen_color;
  if (material.clearcoat + sheen.r + sheen.g + sheen.b > 0) [[unlikely]]
    add_coat(material, frame, carries);
  // specular = metallic = 0: matte, and F0 is 0 as well
  if (const float f90 = material.specular * (1 - metallic) + metallic; f90 > 0) {
    const Schlick fresnel{dielectric_f0(material) * (1 - metallic) + material.base_color * metallic, f90};
    if (material.anisotropy + material.iridescence > 0) [[unlikely]]
      add_reflection(material, fresnel, frame);
    else if (has_lambert_ && metallic > 0) add_round(part_metal(material), material.roughness);
    else add_round(fresnel, material.roughness);
  }
  if (material.diffuse_transmission > 0) [[unlikely]] {
    const float through = material.diffuse_transmission;
    const float beside_glass = 1 - material.transmission * (1 - metallic);  // rest_, which is 1 on a far side
    lambert_.add(far_side_ ? material.diffuse_transmission_color * (through * (1 - metallic) * beside_glass)
                           : material.base_color * ((1 - metallic) * (1 - through)));
    diffuse_ = lit_ && has_lambert_;  // light from one side at least
  } else {
    lambert_.add(material.base_color * (1 - metallic));
    diffuse_ = lit_ && max_component(lambert_.rho()) > 0;
  }
}

/// Adds a reflection that is the same all round: a Mirror below kMirrorRoughness, else a Gloss.
template <class Fresnel>
inline void Bsdf::add_round(const Fresnel& fresnel, float roughness) {
  if (roughness < kMirrorRoughness) add<BasicMirror<Fresnel>>(fresnel);
  else add<BasicGloss<RoundGgx, Fresnel>>(fresnel, RoundGgx(roughness * roughness), rest_);
}

/// Adds the clearcoat, the uppermost lobe, of index 1.5, and the sheen. Not inlined: the registers would slow materials
/// without these lobes.
[[gnu::noinline]] void Bsdf::add_coat(const MaterialValues& material, const Frame* frame, Carries carries) {
  const Schlick fresnel{Rgb(normal_reflectance(1.5f) * material.clearcoat), material.clearcoat};
  const float roughness = material.clearcoat_roughness;
  directed_ = frame && material.clearcoat > 0 && length2(material.axes.coat_normal) > 0;
  if (directed_) {
    const Vec3 axis = frame->to_local(material.axes.coat_normal), normal = axis.z < 0 ? -axis : axis;
    if (roughness < kMirrorRoughness) add<Coat<Mirror>>(Mirror(fresnel), normal, carries);
    else add<Coat<Gloss>>(Gloss(fresnel, RoundGgx(roughness * roughness), rest_), normal, carries);
  } else if (material.clearcoat > 0) {
    add_round(fresnel, roughness);
  }
  if (max_component(material.sheen_color) > 0) add<Sheen>(material.sheen_color, material.sheen_roughness, rest_);
}

/// Adds the reflection of a material with anisotropy or a thin film.
[[gnu::noinline]] void Bsdf::add_reflection(const MaterialValues& material, const Schlick& fresnel,
                                            const Frame* frame) {
  if (const float factor = material.iridescence; factor > 0)
    add_directed(material, ThinFilm(fresnel, factor, material.iridescence_ior, material.iridescence_thickness_maximum),
                 frame);
  else if (material.metallic > 0 && material.metallic < 1) add_directed(material, part_metal(material), frame);
  else add_directed(material, fresnel, frame);
}

/// Adds a reflection along the grain. Without anisotropy or a direction of the grain it is round.
template <class Fresnel>
void Bsdf::add_directed(const MaterialValues& material, const Fresnel& fresnel, const Frame* frame) {
  const float alpha_b = material.roughness * material.roughness;
  const float alpha_t = alpha_b + (1 - alpha_b) * material.anisotropy * material.anisotropy;
  if (frame && material.anisotropy > 0 && length2(material.axes.grain) > 0 &&
      alpha_t >= kMirrorRoughness * kMirrorRoughness) {
    directed_ = true;
    add<BasicGloss<AnisotropicGgx, Fresnel>>(
        fresnel, AnisotropicGgx(alpha_t, alpha_b, frame->to_local(material.axes.grain)), rest_);
  } else {
    add_round(fresnel, material.roughness);
  }
}

/// Adds a lobe of event S below the others.
template <class AnyLobe, class... Parameters>
void Bsdf::add(const Parameters&... parameters) {
  if (!lit_) return;
  Layer& layer = stack_[lobes_++];
  const AnyLobe& lobe = layer.lobe.emplace<AnyLobe>(parameters...);
  if (!AnyLobe::kDelta && !far_side_) ++spread_;
  const float rest = 1 - lobe.mean_kept();
  if (rest > 1e-6f) coupling_scale_ *= 1 / std::sqrt(rest);
  else lit_ = false;
}

}  // namespace tempolux
