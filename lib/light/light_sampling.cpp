// lib/light/light_sampling.cpp -- draws light samples for a point, and evaluates their densities.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/light/lights.h"
#include "lib/light/punctual.h"
#include "lib/light/sky_guide.h"

namespace tempolux {
namespace {

/// Weight with which a directional light is chosen: its irradiance; 0 if the light is below the surface.
double sun_weight(const PlacedLight& placed, Vec3 normal) {
  const double e = max_component(placed.light.intensity);
  return normal == Vec3{} ? e : e * std::max(0.0f, -dot(normal, placed.direction));
}

/// pdf [1/sr] of a direction of the environment that is drawn by radiance or from a grid.
double mixed_pdf(double by_radiance, const SkyGuide::Grid& grid, Vec3 direction) {
  return kUnguidedShare * by_radiance + (1 - kUnguidedShare) * grid.pdf_solid_angle(direction);
}

/// Probability of choosing a distant light. `distant` and `others` are irradiances from both kinds of light, the second
/// only an estimate; so if both are above 0, each kind gets at least a fifth.
double share_of_distant(double distant, double others) {
  return others > 0 ? std::clamp(distant / (distant + others), 0.2, 0.8) : 1;
}

}  // namespace

Lights Lights::guided(std::shared_ptr<const SkyGuide> guide) const {
  Lights lights = *this;
  lights.guide_ = std::move(guide);
  return lights;
}

/// Sum of the weights of the environment and of all directional lights.
double Lights::sum_distant(Vec3 normal) const {
  double total = environment_weight_;
  for (const std::uint32_t i : suns_) total += sun_weight(frame_->lights[i], normal);
  return total;
}

/// Probability of choosing a distant light at a point. `total` receives the weight of the distant lights.
double Lights::distant_share(Vec3 point, Vec3 normal, From from, double& total) const {
  total = distant_irradiance(normal, from);
  return total > 0 ? share_of_distant(total, tree_.start(point, normal).sum) : 0;
}

/// u in [0, 1) chooses among the distant lights; the environment comes first.
bool Lights::sample_distant(Vec3 point, Vec3 normal, Vec2 u_float, double u, double share, double total,
                            LightSample& s) const {
  const double left = u * total;
  if (left < environment_weight_ || total <= environment_weight_)
    return sample_environment(point, normal, u_float, left / environment_weight_, share * environment_weight_ / total,
                              s);
  return sample_sun(point, normal, (left - environment_weight_) / (total - environment_weight_),
                    share * (1 - environment_weight_ / total), s);
}

/// u in [0, 1) chooses among the directional lights; `probability` is the probability of choosing any of them.
bool Lights::sample_sun(Vec3 point, Vec3 normal, double u, double probability, LightSample& s) const {
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
  s.wi = -chosen->direction;
  s.position = point + s.wi * distance_beyond();
  s.facing_irradiance = Rgb(Rgbd(chosen->light.intensity) / (probability * weight / total));
  s.delta = s.distant = true;
  return true;
}

/// u was stretched from u_float.x, which has 24 random bits. Choosing used some of them, so bits made from the other
/// coordinate are added in their places; likewise for u_float.y.
bool Lights::sample_environment(Vec3 point, Vec3 normal, Vec2 u_float, double u, double probability,
                                LightSample& s) const {
  const auto more_bits = [](float other) { return 0x1p-24 * unit_double(mix64(std::bit_cast<std::uint32_t>(other))); };
  EnvironmentLight::Sample found;
  const double u1 = std::min(u + more_bits(u_float.y) / probability, 1 - 0x1p-53),
               u2 = std::min(double(u_float.y) + more_bits(u_float.x), 1 - 0x1p-53);
  const SkyGuide::Grid* const grid = guide_ ? guide_->at(point, normal) : nullptr;
  if (!grid) {
    if (!environment_->sample(u1, u2, found)) return false;
  } else {
    if (u1 >= kUnguidedShare) found.direction = grid->sample((u1 - kUnguidedShare) / (1 - kUnguidedShare), u2);
    else if (!environment_->sample(u1 / kUnguidedShare, u2, found)) return false;
    const EnvironmentLight::Place place = environment_->place_of(found.direction);
    found.radiance = environment_->radiance_at(place);
    found.pdf_solid_angle = mixed_pdf(environment_->pdf_solid_angle(place, found.direction), *grid, found.direction);
  }
  const double pdf = found.pdf_solid_angle * probability;
  s.wi = found.direction;
  s.position = point + s.wi * distance_beyond();
  s.facing_irradiance = Rgb(Rgbd(found.radiance) / pdf);
  s.pdf_solid_angle = float(pdf);
  s.distant = true;
  return s.pdf_solid_angle > 0 && s.pdf_solid_angle < INFINITY;
}

/// Fills the sample with a point or spot light.
bool Lights::sample_placed(const PlacedLight& placed, Vec3 point, double probability, LightSample& s) const {
  const Vec3d to = Vec3d(placed.position) - Vec3d(point);
  const double distance = length(to);
  if (!(distance > 0)) return false;
  // Irradiance must stay finite: closer than a millionth of the scene's radius it no longer grows.
  const double nearest = std::max(distance, 1e-6 * sphere_radius_);
  s.wi = Vec3(to / distance);
  s.position = placed.position;
  double falloff = 1;
  if (placed.light.kind == PunctualLight::Kind::spot)
    falloff = SpotProfile(placed.light).falloff(0.5 * length2(Vec3d(placed.direction) + to / distance));
  s.facing_irradiance = Rgb(Rgbd(placed.light.intensity) * (falloff / (nearest * nearest * probability)));
  s.delta = true;
  return falloff > 0;
}

/// Draws a point on the light of a slot that was chosen with this probability. `left` is the remainder of the number
/// that chose the slot; with `joint` it replaces u.x.
inline bool Lights::sample_slot(std::uint32_t slot, Vec3 point, double probability, double left, Vec2 u, bool joint,
                                LightSample& sample) const {
  if (slot >= triangles_.size())
    return sample_placed(frame_->lights[slots_[slot].light], point, probability, sample) &&
           is_finite(sample.facing_irradiance);
  const TriangleLight& t = triangles_[slot];
  if (joint) {
    // u.x had 24 random bits. The choice of the slot used some of them; bits made from u.y are added in their places.
    const double step = 0x1p-24 / probability, fill = unit_double(mix64(std::bit_cast<std::uint32_t>(u.y)));
    u.x = to_float(std::min(left + fill * step, 1.0));
  }
  TrianglePoint on_triangle;
  if (!sample_triangle(t, point, u, on_triangle)) return false;
  const double pdf = probability * on_triangle.pdf_solid_angle;
  sample.wi = on_triangle.wi;
  sample.position = on_triangle.position;
  sample.position_offset = t.offset;
  sample.facing_irradiance = Rgb(Rgbd(emitted_at(slot, on_triangle.barycentric.x, on_triangle.barycentric.y)) / pdf);
  sample.pdf_solid_angle = float(pdf);
  return sample.pdf_solid_angle > 0 && sample.pdf_solid_angle < INFINITY && is_finite(sample.facing_irradiance);
}

bool Lights::sample_any(Vec3 point, Vec3 normal, float u_choice, Vec2 u, bool joint, From from,
                        LightSample& sample) const {
  sample = {};
  const LightTree::Start start = tree_.start(point, normal);
  const double distant = distant_irradiance(normal, from),
               share = distant > 0 ? share_of_distant(distant, start.sum) : 0;
  if (u_choice < share) {
    // Distant lights use the remainder of u_choice in place of u.x, even if u_choice and u.x are different numbers.
    return sample_distant(point, normal, {u_choice, u.y}, u_choice / share, share, distant, sample) &&
           is_finite(sample.facing_irradiance);
  }
  return sample_tree(start, 1 - share, point, normal, to_float(stretch(u_choice, share, 1 - share)), u, joint, sample);
}

/// Draws a sample of a light inside the scene; `probability` is the probability of choosing any of them.
bool Lights::sample_tree(const LightTree::Start& start, double probability, Vec3 point, Vec3 normal, float u_choice,
                         Vec2 u, bool joint, LightSample& sample) const {
  if (tree_.empty()) return false;
  LightTree::Choice choice;
  if (!tree_.choose(start, point, normal, u_choice, choice)) return false;
  return sample_slot(tree_slot_[choice.light], point, choice.probability * probability, choice.left, u, joint, sample);
}

bool Lights::sample_sun(Vec3 point, Vec3 normal, float u, LightSample& sample) const {
  sample = {};
  return sample_sun(point, normal, double(u), 1, sample) && is_finite(sample.facing_irradiance);
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
  const double on_triangle = pdf_triangle(triangles_[slot], point, on_light);
  if (!(on_triangle > 0)) return 0;
  double total = 0;
  const double share = distant_share(point, normal, from, total);
  const float pdf = float(on_triangle * (1 - share) * tree_.probability(point, normal, light));
  return pdf < INFINITY ? pdf : 0;
}

float Lights::pdf_environment(Vec3 point, Vec3 normal, const EnvironmentLight::Place& place, Vec3 direction,
                              From from) const {
  if (!(environment_weight_ > 0)) return 0;
  double total = 0;
  const double share = distant_share(point, normal, from, total);
  const SkyGuide::Grid* const grid = guide_ ? guide_->at(point, normal) : nullptr;
  const double by_radiance = environment_->pdf_solid_angle(place, direction),
               directed = grid ? mixed_pdf(by_radiance, *grid, direction) : by_radiance;
  const float pdf = float(directed * share * environment_weight_ / total);
  return pdf < INFINITY ? pdf : 0;
}

}  // namespace tempolux
