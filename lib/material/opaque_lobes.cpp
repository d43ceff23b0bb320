#include "lib/material/opaque_lobes.h"

#include <algorithm>
#include <type_traits>

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
float BasicMirror<Fresnel>::mean_kept() const {
  if constexpr (std::is_same_v<Fresnel, PartMetal>) return fresnel_.dielectric.mean_of_largest();
  else return fresnel_.mean_of_largest();
}

template <class Fresnel>
LobeAlbedo BasicMirror<Fresnel>::albedo(Vec3 w) const {
  LobeAlbedo found{.single = fresnel_.at(w.z)};
  if constexpr (std::is_same_v<Fresnel, PartMetal>) found.kept = max_component(fresnel_.dielectric.at(w.z));
  else found.keep_largest();
  return found;
}

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
  const float fade = smooth_step((mean_lost_ - kLeastLost) / (2 * kLeastLost));
  const auto multiple = [&](float mean) { return fade * mean * mean * e / (1 - mean * mean_lost_) / mean_lost_; };
  const auto multiples = [&](const Rgb& mean) {
    return fade > 0 ? Rgb{multiple(mean.r), multiple(mean.g), multiple(mean.b)} : Rgb(0.0f);
  };
  const float lost2 = mean_lost_ * mean_lost_;
  if constexpr (std::is_same_v<Fresnel, PartMetal>) {
    const Rgb above = multiples(fresnel_.dielectric.mean());
    multiple_ = above * (1 - fresnel_.metallic) + multiples(fresnel_.metal.mean()) * fresnel_.metallic;
    kept_multiple_ = max_component(above);
    mean_kept_ = fresnel_.dielectric.mean_albedo(width_, m) + kept_multiple_ * lost2;
  } else {
    multiple_ = multiples(fresnel_.mean());
    mean_kept_ = fresnel_.mean_albedo(width_, m) + max_component(multiple_) * lost2;
  }
}

template <class Width, class Fresnel>
LobeAlbedo BasicGloss<Width, Fresnel>::albedo(Vec3 w) const {
  const AlbedoPair e = width_.albedo(w);
  const float lost = std::max(0.0f, 1 - (e.a + e.b));
  LobeAlbedo found{fresnel_.albedo(width_, w, e), multiple_ * (mean_lost_ * lost), lost};
  if constexpr (std::is_same_v<Fresnel, PartMetal>)
    found.kept = fresnel_.dielectric.mean_albedo(width_, e) + kept_multiple_ * (mean_lost_ * lost);
  else found.keep_largest();
  return found;
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
template class BasicMirror<PartMetal>;
template class BasicGloss<RoundGgx, PartMetal>;
template class BasicGloss<AnisotropicGgx, PartMetal>;
template class BasicGloss<RoundGgx>;
template class BasicGloss<AnisotropicGgx>;
template class BasicMirror<ThinFilm>;
template class BasicGloss<RoundGgx, ThinFilm>;
template class BasicGloss<AnisotropicGgx, ThinFilm>;

}  // namespace tempolux
