// lib/light/light_sampling.cpp -- draws light samples for a point, and evaluates their densities.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/light/lights.h"
#include "lib/light/sky_guide.h"

namespace tempolux {
namespace {

/// Weight with which a directional light is chosen: its irradiance, with the cosine for the highest point of its disc,
/// which the sum cos t + a bounds. 0 if the light is below the surface.
double sun_weight(const PlacedLight& placed, Vec3 normal) {
  const double e = max_component(placed.light.intensity);
  return normal == Vec3{} ? e : e * std::max(0.0f, 0.5f * placed.light.size.angle_rad - dot(normal, placed.direction));
}

/// Least irradiance of the sky over its unshadowed irradiance: a sample may see the sky where no ray of the guide did.
constexpr double kLeastSky = 1.0 / 256;

}  // namespace

Lights Lights::guided(std::shared_ptr<const SkyGuide> guide) const {
  Lights lights = *this;
  lights.guide_ = std::move(guide);
  return lights;
}

/// The irradiance of the lights inside the scene is only an estimate. So if they shine as well, each kind gets at least
/// a fifth.
double Lights::Distant::share(double tree) const {
  const double others = lamps * tree;
  return !(all() > 0) ? 0 : others > 0 ? std::clamp(all() / (all() + others), 0.2, 0.8) : 1;
}

/// The sky counts with the irradiance that the guide has learned, which walls reduce. Suns count unshadowed, so beside
/// them the sky counts unshadowed, too.
Lights::Distant Lights::distant_at(Vec3 point, Vec3 normal, From from) const {
  if (!has_distant()) return {};
  Distant distant{.sky = environment_weight_};
  if (from == From::all)
    for (const std::uint32_t i : suns_) distant.suns += sun_weight(frame_->lights[i], normal);
  if (!guide_) return distant;
  const SkyGuide::Part* const part = guide_->at(point, normal);
  distant.grid = guide_->grid_of(part);
  if (!part || distant.suns > 0) return distant;
  distant.lamps = part->lamps;
  const double by_radiance = std::sqrt(part->irradiance * environment_weight_);
  distant.sky = std::clamp(part->rms > 0 ? std::min(part->rms, by_radiance) : by_radiance,
                           kLeastSky * environment_weight_, environment_weight_);
  return distant;
}

/// u_float.x / share in [0, 1) chooses among the distant lights; the environment comes first.
bool Lights::sample_distant(Vec3 point, Vec3 normal, Vec2 u_float, double share, const Distant& distant,
                            LightSample& s) const {
  const double left = double(u_float.x) / share * distant.all();
  if (left < distant.sky || !(distant.suns > 0))
    return sky(distant.grid).sample(point, share * distant.sky / distant.all(), left / distant.sky, u_float, s);
  return sample_sun(point, normal, (left - distant.sky) / distant.suns, u_float.y, share * distant.suns / distant.all(),
                    s);
}

/// u in [0, 1) chooses among the directional lights; `probability` is the probability of choosing any of them. What is
/// left of u, and u_disc, choose a direction of the light's disc.
bool Lights::sample_sun(Vec3 point, Vec3 normal, double u, float u_disc, double probability, LightSample& s) const {
  double total = 0, weight = 0;
  for (const std::uint32_t i : suns_) total += sun_weight(frame_->lights[i], normal);
  double left = u * total;
  const PlacedLight* chosen = nullptr;
  for (const std::uint32_t i : suns_) {
    const double w = sun_weight(frame_->lights[i], normal);
    if (!(w > 0)) continue;
    chosen = &frame_->lights[i];
    weight = w;
    if (left < w) break;
    left -= w;
  }
  if (!chosen) return false;
  const Vec2 u_direction = chosen->light.has_size() ? Vec2{to_float(stretch(left, 0, weight)), u_disc} : Vec2{};
  return PunctualSource{*chosen, aim_}.sample(point, u_direction, probability * weight / total, s);
}

/// Draws a point on the light of a slot that was chosen with this probability. `left` is the remainder of the number
/// that chose the slot; with draw.joint it replaces u.x.
inline bool Lights::sample_slot(std::uint32_t slot, Vec3 point, double probability, double left, const Draw& draw,
                                LightSample& sample) const {
  Vec2 u = draw.u;
  if (slot >= triangles_.size()) {
    if (draw.joint) u.x = to_float(left);
    return with(slot,
                [&](const auto& light) {
                  if constexpr (requires { light.sample(point, u, probability, sample); })
                    return light.sample(point, u, probability, sample);
                  return false;
                }) &&
           is_finite(sample.facing_irradiance);
  }
  const TriangleLight& t = triangles_[slot];
  if (draw.joint) {
    // u.x had 24 random bits. The choice of the slot used some of them; bits made from u.y are added in their places.
    const double step = 0x1p-24 / probability, fill = unit_double(mix64(std::bit_cast<std::uint32_t>(u.y)));
    u.x = to_float(std::min(left + fill * step, 1.0));
  }
  TrianglePoint on_triangle;
  if (!t.sample(point, u, on_triangle)) return false;
  const double pdf = probability * on_triangle.pdf_solid_angle;
  sample.wi = on_triangle.wi;
  sample.position = on_triangle.position;
  sample.position_offset = t.offset;
  sample.facing_irradiance = Rgb(Rgbd(emitted_at(slot, on_triangle.barycentric.x, on_triangle.barycentric.y)) / pdf);
  sample.pdf_solid_angle = float(pdf);
  return sample.pdf_solid_angle > 0 && sample.pdf_solid_angle < INFINITY && is_finite(sample.facing_irradiance);
}

bool Lights::sample_any(Vec3 point, Vec3 normal, const Draw& draw, From from, LightSample& sample) const {
  sample = {};
  const LightTree::Start start = tree_.start(point, normal);
  const Distant distant = distant_at(point, normal, from);
  const double share = distant.share(start.sum);
  if (draw.choice < share) {
    // Distant lights use the remainder of the choice in place of u.x, even if the two are different numbers.
    return sample_distant(point, normal, {draw.choice, draw.u.y}, share, distant, sample) &&
           is_finite(sample.facing_irradiance);
  }
  const Draw left{to_float(stretch(draw.choice, share, 1 - share)), draw.u, draw.joint};
  return sample_tree(start, 1 - share, point, normal, left, sample);
}

/// Draws a sample of a light inside the scene; `probability` is the probability of choosing any of them.
bool Lights::sample_tree(const LightTree::Start& start, double probability, Vec3 point, Vec3 normal, const Draw& draw,
                         LightSample& sample) const {
  if (tree_.empty()) return false;
  LightTree::Choice choice;
  if (!tree_.choose(start, point, normal, draw.choice, choice)) return false;
  return sample_slot(tree_slot_[choice.light], point, choice.probability * probability, choice.left, draw, sample);
}

bool Lights::sample_placed(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample, double& unshadowed) const {
  sample = {};
  const LightTree::Start start = tree_.start(point, normal);
  unshadowed = start.sum;
  return sample_tree(start, 1, point, normal, {u.x, u, true}, sample);
}

bool Lights::sample_sun(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample) const {
  sample = {};
  return sample_sun(point, normal, double(u.x), u.y, 1, sample) && is_finite(sample.facing_irradiance);
}

/// The slot of the triangle's part at a point of the triangle.
std::uint32_t Lights::slot_at(std::uint32_t surface, std::uint32_t triangle, Vec3 on_light) const {
  const EmissionParts& parts = *parts_[surface];
  const std::uint32_t first = first_slot_[surface], index = parts.first(triangle);
  if (index + 1 == parts.first(triangle + 1)) return first + index;
  const TriangleLight& t = triangles_[first + index];
  const Vec2 in_part = t.coordinates(on_light), b = t.part.at(in_part.x, in_part.y);
  return first + parts.index(triangle, b.x, b.y);
}

float Lights::pdf_solid_angle(Vec3 point, Vec3 normal, std::uint32_t surface, std::uint32_t triangle, Vec3 on_light,
                              From from) const {
  if (first_slot_[surface] == kNone) return 0;
  const std::uint32_t slot = slot_at(surface, triangle, on_light), light = tree_index_[slot];
  if (light == kNone) return 0;
  const double on_triangle = triangles_[slot].pdf_solid_angle(point, on_light);
  if (!(on_triangle > 0)) return 0;
  const Distant distant = distant_at(point, normal, from);
  const double share = distant.all() > 0 ? distant.share(tree_.start(point, normal).sum) : 0;
  const float pdf = float(on_triangle * (1 - share) * tree_.probability(point, normal, light));
  return pdf < INFINITY ? pdf : 0;
}

float Lights::pdf_environment(Vec3 point, Vec3 normal, const EnvironmentLight::Place& place, Vec3 direction,
                              From from) const {
  if (!(environment_weight_ > 0)) return 0;
  const Distant distant = distant_at(point, normal, from);
  const double share = distant.share(tree_.start(point, normal).sum),
               directed = sky(distant.grid).pdf_solid_angle(place, direction);
  const float pdf = float(directed * share * distant.sky / distant.all());
  return pdf < INFINITY ? pdf : 0;
}

}  // namespace tempolux
