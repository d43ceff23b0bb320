#include "lib/material/bsdf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace tempolux {
namespace {

/// The share of light that a lobe of this albedo lets through.
float let_through(const LobeAlbedo& albedo) { return std::max(0.0f, 1 - albedo.kept); }

}  // namespace

/// function(lobe) of a lobe of the stack.
template <class Function>
auto Bsdf::visit(int i, Function&& function) const {
  return std::visit(
      [&](const auto& lobe) -> decltype(function(std::declval<const Mirror&>())) {
        if constexpr (std::is_same_v<decltype(lobe), const std::monostate&>) __builtin_unreachable();
        else return function(lobe);
      },
      stack_[i].lobe);
}

Bsdf Bsdf::turned(const Frame& from, const Frame& to) const {
  Bsdf turned = *this;
  for (int i = 0; i < lobes_; ++i)
    std::visit(
        [&](auto& lobe) {
          if constexpr (requires { lobe.turn(from, to); }) lobe.turn(from, to);
        },
        turned.stack_[std::size_t(i)].lobe);
  return turned;
}

void Bsdf::look_up(Direction& d) const {
  for (int i = 0; i < lobes_; ++i) {
    new (d.albedo + i) LobeAlbedo(visit(i, [&](const auto& lobe) { return lobe.albedo(d.w); }));
    d.albedo[i].passed = d.passed;
    d.passed *= let_through(d.albedo[i]);
  }
}

/// The share of uniform light that stack_[i] reflects towards d through the lobes above it.
Rgb Bsdf::reflected(int i, const Direction& d) const {
  const Rgb total = d.albedo[i].total();
  return i > 0 ? total * d.albedo[i].passed : total;
}

Rgb Bsdf::specular_albedo(Vec3 wo) const {
  if (far_side_) return Rgb(0.0f);
  Direction d(wo);
  look_up(d);
  Rgb sum(0.0f);
  for (int i = 0; i < lobes_; ++i) sum += reflected(i, d);
  return sum;
}

float Bsdf::diffuse_coupling(Vec3 w) const {
  if (lobes_ == 0) return 1;
  float passed = 1;
  for (int i = 0; i < lobes_; ++i) passed *= visit(i, [&](const auto& lobe) { return let_through(lobe.albedo(w)); });
  return passed * coupling_scale_;
}

Rgb Bsdf::diffuse_reflectance(Vec3 wo) const {
  return (lobes_ > 0 ? lambert_.rho() * (diffuse_coupling(wo) / coupling_scale_) : lambert_.rho()) * rest_;
}

float Bsdf::arrival_weight(Vec3 wi) const { return diffuse_coupling(wi) * coupling_scale_; }

/// P(D): the Lambert lobe's share of the uniform light that all lobes together reflect towards wo.
float Bsdf::diffuse_probability(const Direction& wo) const {
  if (!has_diffuse()) return 0;
  if (lobes_ == 0 || far_side_) return 1;
  const float d = channel_mean(lambert_.rho()) * wo.passed;
  float total = d;
  for (int i = 0; i < lobes_; ++i) total += channel_mean(reflected(i, wo));
  return total > 0 ? d / total : 0;
}

Rgb Bsdf::eval_diffuse(const Direction& wi, const Direction& wo) const {
  if (!has_diffuse() || !(wi.w.z > 0) || !(wo.w.z > 0)) return Rgb(0.0f);
  return lambert_.eval(coupling(wi), coupling(wo), rest_);
}

Rgb Bsdf::eval_specular(const Direction& wi, const Direction& wo) const {
  Rgb f(0.0f);
  if (spread_ == 0 || !(wo.w.z > 0)) return f;
  if (wi.w.z > 0) {
    for (int i = 0; i < lobes_; ++i)
      f += visit(i, [&](const auto& lobe) { return lobe.eval(seen(wi, i), seen(wo, i)); });
  }
  return glass_ ? f + glass_->eval(wi.w, wo.w) : f;
}

float Bsdf::pdf_diffuse(Vec3 wi, const Direction& wo) const {
  if (!has_diffuse() || !(wi.z > 0) || !(wo.w.z > 0)) return 0;
  return diffuse_probability(wo) * lambert_.pdf_solid_angle(wi) * rest_;
}

/// pdf [1/sr] of wi under the condition that the stack draws event S; wi and wo are above the surface.
float Bsdf::pdf_given_specular(Vec3 wi, const Direction& wo) const {
  const auto pdf = [&](int i) {
    return visit(i, [&](const auto& lobe) { return lobe.pdf_solid_angle(wi, seen(wo, i)); });
  };
  if (lobes_ == 1) return pdf(0);
  float sum = 0, total = 0;
  for (int i = 0; i < lobes_; ++i) {
    const float b = channel_mean(reflected(i, wo));
    sum += b * pdf(i), total += b;
  }
  return total > 0 ? sum / total : 0;
}

float Bsdf::pdf_specular(Vec3 wi, const Direction& wo) const {
  if (spread_ == 0 || !(wo.w.z > 0)) return 0;
  const float pdf = glass_ ? glass_->pdf_solid_angle(wi, wo.w) : 0;
  if (lobes_ == 0 || !(wi.z > 0)) return pdf;
  return pdf + (1 - diffuse_probability(wo)) * pdf_given_specular(wi, wo) * rest_;
}

float Bsdf::gloss_density(Vec3 wi, const Direction& wo) const {
  const bool gloss = spread_ > 0 && !glass_ && wi.z > 0 && wo.w.z > 0;
  return gloss ? pdf_given_specular(wi, wo) : std::numeric_limits<float>::infinity();
}

bool Bsdf::draws_diffuse(const Direction& wo, float u_lobe) const {
  if (!has_diffuse() || !(wo.w.z > 0)) return false;
  if (glass_) {
    if (u_lobe < glass_->share()) return false;
    u_lobe = stretched(u_lobe);
  }
  return u_lobe < diffuse_probability(wo);
}

float Bsdf::fork_probability(const Direction& wo) const {
  if (!(wo.w.z > 0)) return 1;
  return glass_ ? glass_->reflectance(wo.w.z) : diffuse_probability(wo);
}

/// Draws a lobe of the stack in proportion to the light that it reflects, and stretches u_lobe to [0, 1). `chance` is
/// multiplied by the lobe's probability.
int Bsdf::choose(const Direction& wo, float& u_lobe, float& chance) const {
  int i = 0;
  if (lobes_ == 1) return i;
  float total = 0;
  for (int lobe = 0; lobe < lobes_; ++lobe) total += channel_mean(reflected(lobe, wo));
  float share = channel_mean(reflected(0, wo)) / total;
  while (i + 1 < lobes_ && u_lobe >= share) {
    u_lobe -= share;
    share = channel_mean(reflected(++i, wo)) / total;
  }
  u_lobe = std::min(kOneMinusEpsilon, u_lobe / share);
  chance *= share;
  return i;
}

/// Event D, drawn with probability p. Weight and pdf are those of the stack alone.
void Bsdf::sample_diffuse(const Direction& wo, Vec2 u, float p, Sample& s) const {
  s.diffuse = true;
  s.wi = sample_hemisphere_cos(u);
  s.pdf_solid_angle = p * lambert_.pdf_solid_angle(s.wi);
  s.weight = lambert_.rho();  // f_D cos / pdf_D; c = 1
  if (lobes_ == 0) return;
  s.weight *= diffuse_coupling(s.wi) * coupling(wo) / p;
  s.pdf_solid_angle += (1 - p) * pdf_given_specular(s.wi, wo);
}

/// Event S, drawn with probability 1 - p. The weight is that of one lobe; the pdf is that of this lobe and of event D.
void Bsdf::sample_specular(const Direction& wo, float u_lobe, Vec2 u, float p, Sample& s) const {
  const float event = 1 - p;
  float chance = event;
  const int i = choose(wo, u_lobe, chance);
  if (!(chance > 0)) return;  // all lobes are black
  visit(i, [&](const auto& lobe) {
    const LobeDirection o = seen(wo, i);
    lobe.sample(o, u_lobe, u, s);
    if (!(s.pdf_solid_angle > 0)) return;
    s.pdf_solid_angle *= chance;
    constexpr bool mirror = std::is_same_v<std::decay_t<decltype(lobe)>, Mirror>;
    if (mirror && !directed_) {  // this lobe and those above have the same albedo towards wi
      s.weight = lobe.weight(o, o, chance, s.pdf_solid_angle);
    } else {
      const Direction wi = along(s.wi);
      s.weight = lobe.weight(seen(wi, i), o, chance, s.pdf_solid_angle);
      if (!s.delta) s.pdf_solid_angle += (1 - event) * lambert_.pdf_solid_angle(s.wi);
    }
  });
}

void Bsdf::sample_stack(const Direction& wo, float u_lobe, Vec2 u, Sample& s) const {
  const float p = diffuse_probability(wo);
  if (u_lobe < p) sample_diffuse(wo, u, p, s);
  else if (lobes_ > 0) sample_specular(wo, (u_lobe - p) / (1 - p), u, p, s);
}

/// Weighs a sample of event S by all lobes of that event.
void Bsdf::weigh_by_all(const Direction& wo, Sample& s) const {
  const float pdf = pdf_specular(s.wi, wo);
  s.weight = pdf > 0 ? eval_specular(along(s.wi), wo) * (std::abs(s.wi.z) / pdf) : Rgb(0.0f);
  s.pdf_solid_angle = pdf > 0 ? pdf + pdf_diffuse(s.wi, wo) : 0;
}

Bsdf::Sample Bsdf::sample(const Direction& wo, float u_lobe, Vec2 u) const {
  Sample s;
  if (!(wo.w.z > 0)) return s;
  if (!glass_) {
    sample_stack(wo, u_lobe, u, s);
  } else if (u_lobe < glass_->share()) {
    glass_->sample(wo.w, u_lobe / glass_->share(), u, s);
    if (!s.delta && s.wi.z != 0) weigh_by_all(wo, s);
    return s;
  } else {
    sample_stack(wo, stretched(u_lobe), u, s);
    s.pdf_solid_angle *= rest_;
    if (s.diffuse) s.pdf_solid_angle += glass_->pdf_solid_angle(s.wi, wo.w);
  }
  if (spread_ > 1 && !s.diffuse && !s.delta && s.pdf_solid_angle > 0) weigh_by_all(wo, s);
  return s;
}

}  // namespace tempolux
