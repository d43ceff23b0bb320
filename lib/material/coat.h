// lib/material/coat.h -- a clearcoat whose normal differs from that of the surface below it.
#pragma once

#include <algorithm>

#include "lib/core/frame.h"
#include "lib/material/opaque_lobes.h"

namespace tempolux {

/// Which end of a path the direction wo of a Bsdf leads to.
enum class Carries : std::uint8_t { radiance, flux };  ///< wo leads to the eye; wo leads to the light (photons)

/// A reflection (Mirror or Gloss) about a normal n_c of its own; functions as in lobe.h. KHR_materials_clearcoat: an
/// interface of index 1.5 that bends no light on its way to the layers below.
///
/// A camera path that meets only the coat has the factor f_c(wi, wo) wi.n_c, as if n_c were the shading normal. Bsdf
/// multiplies f by wi.n, the cosine to the normal of the surface below. So the lobe is
///     f(wi, wo) = f_c(wi, wo) (wi.n_c) / (wi.n),          wi: to the light.
/// The lobe is not symmetric, because the shading normals differ. For photons wo leads to the light, and the factor is
/// (wo.n_c) / (wo.n): the adjoint of Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.3.
/// Light from behind n_c is not reflected; it passes as much of the coat as grazing light.
template <class Reflection>
class Coat {
 public:
  static constexpr bool kDelta = Reflection::kDelta;

  /// normal: n_c in the local frame, unit.
  Coat(const Reflection& reflection, Vec3 normal, Carries carries)
      : reflection_(reflection), normal_(normal), carries_(carries) {}

  /// Expresses the normal in another local frame.
  void turn(const Frame& from, const Frame& to) { normal_ = to.to_local(from.to_world(normal_)); }
  float mean_kept() const { return reflection_.mean_kept(); }
  LobeAlbedo albedo(Vec3 w) const { return reflection_.albedo({0, 0, std::max(kGrazing, dot(w, normal_))}); }
  Rgb eval(LobeDirection wi, LobeDirection wo) const {
    const float ci = dot(wi.w, normal_), co = dot(wo.w, normal_);
    if (!(ci > 0 && co > 0)) return Rgb(0.0f);
    const Frame frame(normal_);
    return turned(frame, wi, wo, [&](const auto& i, const auto& o) { return reflection_.eval(i, o); }) *
           (carries_ == Carries::radiance ? ci / wi.w.z : co / wo.w.z);
  }
  float pdf_solid_angle(Vec3 wi, LobeDirection wo) const {
    if (!(dot(wi, normal_) > 0 && dot(wo.w, normal_) > 0)) return 0;
    const Frame frame(normal_);
    const Vec3 o = frame.to_local(wo.w);
    return reflection_.pdf_solid_angle(frame.to_local(wi), {o, wo.albedo});
  }
  void sample(LobeDirection wo, float u_lobe, Vec2 u, LobeSample& s) const {
    if (!(dot(wo.w, normal_) > 0)) return;
    const Frame frame(normal_);
    const Vec3 o = frame.to_local(wo.w);
    reflection_.sample({o, wo.albedo}, u_lobe, u, s);
    s.wi = frame.to_world(s.wi);
    if (!(s.wi.z > 0)) s.pdf_solid_angle = 0;  // reflected into the surface below: absorbed
  }
  Rgb weight(LobeDirection wi, LobeDirection wo, float chance, float pdf) const {
    const float ci = dot(wi.w, normal_), co = dot(wo.w, normal_);
    const Frame frame(normal_);
    const Rgb w =
        turned(frame, wi, wo, [&](const auto& i, const auto& o) { return reflection_.weight(i, o, chance, pdf); });
    return carries_ == Carries::radiance ? w : w * (co / wo.w.z * wi.w.z / std::max(kGrazing, ci));
  }

 private:
  static constexpr float kGrazing = 1e-6f;

  template <class Function>
  static Rgb turned(const Frame& frame, LobeDirection wi, LobeDirection wo, const Function& function) {
    const Vec3 i = frame.to_local(wi.w), o = frame.to_local(wo.w);
    return function(LobeDirection{i, wi.albedo}, LobeDirection{o, wo.albedo});
  }

  Reflection reflection_;
  Vec3 normal_;
  Carries carries_;
};

}  // namespace tempolux
