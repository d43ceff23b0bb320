#include "lib/material/opaque_lobes.h"

#include <algorithm>

#include "lib/material/thin_film.h"

namespace tempolux {
namespace {

float smooth_step(float x) {
  x = std::clamp(x, 0.0f, 1.0f);
  return x * x * (3 - 2 * x);
}
/// If GGX loses less than this share of light on average, f_ms is dropped: it would be concentrated at grazing angles,
/// and its cosine-distributed samples would have weights of more than ten times their mean. Between this loss and three
/// times this loss f_ms is faded in.
constexpr float kLeastLost = 0.01f;

/// The share of a gloss's light that several microfacets reflect. [1]
float multiple_share(const LobeAlbedo& r) {
  const float multiple = channel_mean(r.multiple), total = multiple + channel_mean(r.single);
  return total > 0 ? multiple / total : 0;
}

}  // namespace

Rgb Schlick::at(float cos_h) const {
  const float k = schlick_rise(cos_h);
  return f0 * (1 - k) + Rgb(f90 * k);
}

Rgb Schlick::mean() const { return (f0 * 20 + Rgb(f90)) / 21; }

template <class Fresnel>
void BasicMirror<Fresnel>::sample(LobeDirection wo, float, Vec2, LobeSample& s) const {
  if (!(max_component(wo.albedo.single) > 0)) return;
  s.delta = true;
  s.wi = {-wo.w.x, -wo.w.y, wo.w.z};
  s.pdf_solid_angle = 1;
}

template <class Fresnel>
Rgb BasicMirror<Fresnel>::weight(LobeDirection wi, LobeDirection wo, float chance, float) const {
  return wo.albedo.single * passed_both(wi, wo) / chance;
}

template <class Width, class Fresnel>
BasicGloss<Width, Fresnel>::BasicGloss(const Fresnel& fresnel, const Width& width, float share)
    : fresnel_(fresnel), share_(share), width_(width) {
  const AlbedoPair m = width_.mean_albedo();
  const float e = m.a + m.b;
  mean_lost_ = 1 - e;
  if (const float fade = smooth_step((mean_lost_ - kLeastLost) / (2 * kLeastLost)); fade > 0) {
    const Rgb mean = fresnel_.mean();
    for (int c = 0; c < 3; ++c) multiple_[c] = fade * mean[c] * mean[c] * e / (1 - mean[c] * mean_lost_) / mean_lost_;
  }
  mean_albedo_ = fresnel_.mean_albedo(width_, m) + max_component(multiple_) * mean_lost_ * mean_lost_;
}

template <class Width, class Fresnel>
LobeAlbedo BasicGloss<Width, Fresnel>::albedo(Vec3 w) const {
  const AlbedoPair e = width_.albedo(w);
  const float lost = std::max(0.0f, 1 - (e.a + e.b));
  return {fresnel_.albedo(width_, w, e), multiple_ * (mean_lost_ * lost), lost};
}

/// f [1/sr] without share and coupling.
template <class Width, class Fresnel>
Rgb BasicGloss<Width, Fresnel>::f(LobeDirection wi, LobeDirection wo) const {
  const Vec3 h = normalize(wi.w + wo.w);
  const float d = width_.reflection(wi.w, wo.w, h);
  return fresnel_.at(dot(wo.w, h)) * d + multiple_ * (kInvPi * wi.albedo.lost * wo.albedo.lost);
}

template <class Width, class Fresnel>
Rgb BasicGloss<Width, Fresnel>::eval(LobeDirection wi, LobeDirection wo) const {
  return f(wi, wo) * (passed_both(wi, wo) * share_);
}

/// Visible normals for single reflection, the cosine for multiple reflection.
template <class Width, class Fresnel>
float BasicGloss<Width, Fresnel>::pdf_solid_angle(Vec3 wi, LobeDirection wo) const {
  const float share = multiple_share(wo.albedo);
  return (1 - share) * width_.pdf_reflected(normalize(wi + wo.w), wo.w) + share * pdf_hemisphere_cos(wi.z);
}

template <class Width, class Fresnel>
void BasicGloss<Width, Fresnel>::sample(LobeDirection wo, float u_lobe, Vec2 u, LobeSample& s) const {
  if (!(max_component(wo.albedo.single) > 0)) return;
  if (u_lobe < multiple_share(wo.albedo)) {
    s.wi = sample_hemisphere_cos(u);
  } else {
    const Vec3 h = width_.sample_normal(wo.w, u);
    s.wi = normalize(h * (2 * dot(wo.w, h)) - wo.w);
  }
  if (s.wi.z > 0) s.pdf_solid_angle = pdf_solid_angle(s.wi, wo);  // else reflected into the surface: absorbed
}

template <class Width, class Fresnel>
Rgb BasicGloss<Width, Fresnel>::weight(LobeDirection wi, LobeDirection wo, float, float pdf) const {
  return f(wi, wo) * (passed_both(wi, wo) * (wi.w.z / pdf));
}

template class BasicMirror<Schlick>;
template class BasicGloss<RoundGgx>;
template class BasicGloss<AnisotropicGgx>;
template class BasicMirror<ThinFilm>;
template class BasicGloss<RoundGgx, ThinFilm>;
template class BasicGloss<AnisotropicGgx, ThinFilm>;

}  // namespace tempolux
