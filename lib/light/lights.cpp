#include "lib/light/lights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <sstream>

#include "formats/error.h"
#include "lib/core/check.h"
#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/light/light_tree.h"
#include "lib/light/punctual.h"
#include "lib/light/triangle_light.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

EmissionSlot::Kind slot_kind(PunctualLight::Kind kind) {
  switch (kind) {
    case PunctualLight::Kind::point:
      return EmissionSlot::Kind::point;
    case PunctualLight::Kind::spot:
      return EmissionSlot::Kind::spot;
    case PunctualLight::Kind::directional:
      return EmissionSlot::Kind::directional;
  }
  return EmissionSlot::Kind::point;
}

[[noreturn]] void refuse_flux(const Scene* scene, double flux) {
  std::ostringstream text;
  text << (scene ? scene->path + ": " : "") << "a light of " << flux
       << " W is stronger than a photon's flux can be, 3.4e38 W; make the scene smaller or its lights weaker";
  throw InputError(text.str());
}

LightBounds bounds_of(const TriangleLight& t) {
  LightBounds b;
  b.box.add(t.corner);
  b.box.add(t.corner + t.edge1);
  b.box.add(t.corner + t.edge2);
  b.axis = t.normal;
  b.weight = double(max_component(t.radiance)) * t.area;
  b.two_sided = t.two_sided;
  return b;
}

LightBounds bounds_of(const PlacedLight& placed) {
  LightBounds b;
  b.box.add(placed.position);
  b.axis = placed.direction;
  b.weight = max_component(placed.light.intensity);
  b.cos_spread = -1;
  if (placed.light.kind == PunctualLight::Kind::spot) {
    // The cone's axis is a normal; its light reaches as far as the outer angle.
    b.cos_spread = std::cos(std::min(placed.light.inner_cone_rad, placed.light.outer_cone_rad));
    b.cos_reach = std::max(0.0f, std::cos(placed.light.outer_cone_rad - std::acos(b.cos_spread)));
  }
  return b;
}

/// Irradiance of a directional light, as a weight for choosing it; 0 if it is below the surface.
double sun_weight(const PlacedLight& placed, Vec3 normal) {
  const double e = max_component(placed.light.intensity);
  return normal == Vec3{} ? e : e * std::max(0.0f, -dot(normal, placed.direction));
}

/// The double u in part [first, first + width) of [0, 1), stretched to [0, 1).
double stretch(double u, double first, double width) {
  return std::clamp((u - first) / width, 0.0, 1 - 0x1p-53);
}
float to_float(double u) { return std::min(float(u), kOneMinusEpsilon); }

}  // namespace

struct Lights::Impl {
  bool sample(Vec3 point, Vec3 normal, float u_choice, Vec2 u, bool joint, LightSample& sample) const;
  const SceneFrame* frame;
  Vec3 sphere_centre;
  double sphere_radius;
  std::vector<EmissionSlot> slots;
  std::vector<TriangleLight> triangles;   // of the first slots, same order
  std::vector<double> cumulative;         // of the probabilities; by slot its upper end
  std::vector<std::uint32_t> first_slot;  // by surface; kNone: emits nothing
  std::vector<std::uint32_t> tree_index;  // by slot: its light in the tree, kNone: emits nothing
  std::vector<std::uint32_t> tree_slot;   // and back
  std::vector<std::uint32_t> suns;        // indices of directional lights that shine
  std::shared_ptr<const EnvironmentLight> environment;
  double environment_weight = 0;  // irradiance by the environment, the mean over all normals; 0: none or black
  LightTree tree{{}};

  Impl(const SceneFrame& frame_, const EmissionTable& table);
  void add_slots(const EmissionTable& table);
  void build_tree();

  double distant_share(Vec3 point, Vec3 normal, double& total) const;
  bool sample_distant(Vec3 point, Vec3 normal, Vec2 u_float, double u, double share, double total,
                      LightSample& s) const;
  bool sample_environment(Vec3 point, Vec2 u_float, double u, double probability, LightSample& s) const;
  double disc_area() const { return std::numbers::pi * sphere_radius * sphere_radius; }
  float distance_beyond() const { return float(sphere_radius > 0 ? 2 * sphere_radius : 1); }
  bool sample_placed(const PlacedLight& placed, Vec3 point, double probability, LightSample& s) const;
  /// Radiance of a point of a slot's triangle, by barycentrics.
  Rgb emitted_at(std::size_t slot, double b1, double b2) const {
    return triangles[slot].emitted_at(*frame, slots[slot].surface, slots[slot].triangle, b1, b2);
  }
  Rgbd emit_triangle(std::size_t slot, const double u[4], PhotonEmission& e) const;
  Rgbd emit_environment(const double u[4], PhotonEmission& e) const;
  void emit_punctual(const PlacedLight& placed, const double u[4], PhotonEmission& e) const;
};

Lights::Impl::Impl(const SceneFrame& frame_, const EmissionTable& table)
    : frame(&frame_), sphere_centre(Vec3(table.sphere_centre)), sphere_radius(table.sphere_radius), environment(table.environment) {
  if (environment) environment_weight = max_component(environment->integral()) / 4;
  add_slots(table);
  build_tree();
}

void Lights::Impl::add_slots(const EmissionTable& table) {
  first_slot.assign(frame->surfaces.size(), kNone);
  for (const std::uint32_t s : table.surfaces) {
    const Surface& surface = frame->surfaces[s];
    first_slot[s] = std::uint32_t(slots.size());
    for (std::uint32_t t = 0; t < surface.primitive->triangles.size(); ++t) {
      slots.push_back({EmissionSlot::Kind::triangle, s, t, kNone, 0});
      triangles.emplace_back(*frame, s, t);
    }
  }
  for (std::uint32_t i = 0; i < frame->lights.size(); ++i)
    slots.push_back({slot_kind(frame->lights[i].light.kind), kNone, 0, i, 0});
  if (environment) slots.push_back({EmissionSlot::Kind::environment, kNone, 0, kNone, 0});
  TEMPOLUX_CHECK(slots.size() == table.probability.size());
  double sum = 0;
  cumulative.reserve(slots.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    slots[i].probability = table.probability[i];
    cumulative.push_back(sum += table.probability[i]);
  }
}

void Lights::Impl::build_tree() {
  std::vector<LightBounds> bounds;
  tree_index.assign(slots.size(), kNone);
  for (std::uint32_t i = 0; i < slots.size(); ++i) {
    if (i < triangles.size()) {
      if (!triangles[i].emits()) continue;
      bounds.push_back(bounds_of(triangles[i]));
    } else {
      if (slots[i].kind == EmissionSlot::Kind::environment) continue;
      const PlacedLight& placed = frame->lights[slots[i].light];
      if (!(max_component(placed.light.intensity) > 0)) continue;
      if (slots[i].kind == EmissionSlot::Kind::directional) {
        suns.push_back(slots[i].light);
        continue;
      }
      bounds.push_back(bounds_of(placed));
    }
    tree_index[i] = std::uint32_t(tree_slot.size());
    tree_slot.push_back(i);
  }
  tree = LightTree(bounds);
}

Lights::Lights(const SceneFrame& frame, const EmissionTable& table)
    : impl_(std::make_unique<Impl>(frame, table)), environment_(impl_->environment.get()) {}
Lights::~Lights() = default;
Lights::Lights(Lights&&) noexcept = default;

bool Lights::empty() const { return impl_->slots.empty(); }
std::size_t Lights::count() const { return impl_->slots.size(); }
const std::vector<EmissionSlot>& Lights::slots() const { return impl_->slots; }

Rgbd Lights::total_flux() const {
  Rgbd sum;
  for (const TriangleLight& t : impl_->triangles) sum += t.flux();
  for (const PlacedLight& placed : impl_->frame->lights)
    sum += punctual_flux(placed.light, impl_->sphere_radius);
  if (environment_) sum += environment_->integral() * impl_->disc_area();
  return sum;
}

/// Probability of choosing a light from infinitely far: their share of an estimate of the irradiance, at least a
/// fifth for either kind that can be seen at all. total: the weights of the environment and the directional lights.
double Lights::Impl::distant_share(Vec3 point, Vec3 normal, double& total) const {
  total = environment_weight;
  if (suns.empty() && !(total > 0)) return 0;
  for (const std::uint32_t i : suns) total += sun_weight(frame->lights[i], normal);
  if (!(total > 0)) return 0;
  const double others = tree.importance(point, normal);
  return others > 0 ? std::clamp(total / (total + others), 0.2, 0.8) : 1;
}

/// u in [0, 1) chooses among them: the environment first.
bool Lights::Impl::sample_distant(Vec3 point, Vec3 normal, Vec2 u_float, double u, double share, double total,
                                  LightSample& s) const {
  double weight = 0, left = u * total;
  if (left < environment_weight)
    return sample_environment(point, u_float, left / environment_weight, share * environment_weight / total, s);
  left -= environment_weight;
  const PlacedLight* chosen = nullptr;
  for (const std::uint32_t i : suns) {
    const double w = sun_weight(frame->lights[i], normal);
    if (!(w > 0)) continue;
    chosen = &frame->lights[i];
    weight = w;
    if (left < w) break;
    left -= w;
  }
  if (!chosen) return false;
  s.wi = -chosen->direction;
  s.position = point + s.wi * distance_beyond();
  s.radiance = Rgb(Rgbd(chosen->light.intensity) / (share * weight / total));
  s.delta = true;
  return true;
}

/// u_float: what u comes from. Where its 24 bits are used up, bits of the other coordinate take their place.
bool Lights::Impl::sample_environment(Vec3 point, Vec2 u_float, double u, double probability, LightSample& s) const {
  const auto more_bits = [](float other) { return 0x1p-24 * unit_double(mix64(std::bit_cast<std::uint32_t>(other))); };
  EnvironmentLight::Sample found;
  if (!environment->sample(std::min(u + more_bits(u_float.y) / probability, 1 - 0x1p-53),
                           std::min(double(u_float.y) + more_bits(u_float.x), 1 - 0x1p-53), found))
    return false;
  const double pdf = found.pdf_solid_angle * probability;
  s.wi = found.direction;
  s.position = point + s.wi * distance_beyond();
  s.radiance = Rgb(Rgbd(found.radiance) / pdf);
  s.pdf_solid_angle = float(pdf);
  return s.pdf_solid_angle > 0 && s.pdf_solid_angle < INFINITY;
}

/// A point or spot light.
bool Lights::Impl::sample_placed(const PlacedLight& placed, Vec3 point, double probability,
                                 LightSample& s) const {
  const Vec3d to = Vec3d(placed.position) - Vec3d(point);
  const double distance = length(to);
  if (!(distance > 0)) return false;
  // Nearer than a millionth of the scene, the light is as bright as there.
  const double nearest = std::max(distance, 1e-6 * sphere_radius);
  s.wi = Vec3(to / distance);
  s.position = placed.position;
  double falloff = 1;
  if (placed.light.kind == PunctualLight::Kind::spot)
    falloff = SpotProfile(placed.light).falloff(0.5 * length2(Vec3d(placed.direction) + to / distance));
  s.radiance = Rgb(Rgbd(placed.light.intensity) * (falloff / (nearest * nearest * probability)));
  s.delta = true;
  return falloff > 0;
}

bool Lights::sample(Vec3 point, Vec3 normal, float u_choice, Vec2 u, LightSample& sample) const {
  return impl_->sample(point, normal, u_choice, u, false, sample);
}

bool Lights::sample(Vec3 point, Vec3 normal, Vec2 u, LightSample& sample) const {
  return impl_->sample(point, normal, u.x, u, true, sample);
}

bool Lights::Impl::sample(Vec3 point, Vec3 normal, float u_choice, Vec2 u, bool joint, LightSample& sample) const {
  const Impl& m = *this;
  sample = {};
  double total = 0;
  const double share = m.distant_share(point, normal, total);
  if (u_choice < share) {
    // The environment takes what the choice leaves of its number in place of u.x, also where they are two.
    return m.sample_distant(point, normal, {u_choice, u.y}, u_choice / share, share, total, sample) &&
           is_finite(sample.radiance);
  }
  if (m.tree.empty()) return false;
  LightTree::Choice choice;
  const float left = to_float(stretch(u_choice, share, 1 - share));
  if (!m.tree.choose(point, normal, left, choice)) return false;
  const double probability = choice.probability * (1 - share);
  const std::uint32_t slot = m.tree_slot[choice.light];
  if (slot >= m.triangles.size())
    return m.sample_placed(m.frame->lights[m.slots[slot].light], point, probability, sample) &&
           is_finite(sample.radiance);
  const TriangleLight& t = m.triangles[slot];
  if (joint) {
    // A float has 24 bits: where the choice has used them up, bits of the other coordinate take their place.
    const double step = 0x1p-24 / probability, fill = unit_double(mix64(std::bit_cast<std::uint32_t>(u.y)));
    u.x = to_float(std::min(choice.left + fill * step, 1.0));
  }
  TrianglePoint on_triangle;
  if (!sample_triangle(t, point, u, on_triangle)) return false;
  const double pdf = probability * on_triangle.pdf_solid_angle;
  sample.wi = on_triangle.wi;
  sample.position = on_triangle.position;
  sample.position_offset = t.offset;
  sample.radiance = Rgb(Rgbd(m.emitted_at(slot, on_triangle.barycentric.x, on_triangle.barycentric.y)) / pdf);
  sample.pdf_solid_angle = float(pdf);
  return sample.pdf_solid_angle > 0 && sample.pdf_solid_angle < INFINITY && is_finite(sample.radiance);
}

float Lights::pdf_solid_angle(Vec3 point, Vec3 normal, std::uint32_t surface, std::uint32_t triangle,
                              Vec3 on_light, Vec3) const {
  const Impl& m = *impl_;
  if (m.first_slot[surface] == kNone) return 0;
  const std::uint32_t slot = m.first_slot[surface] + triangle, light = m.tree_index[slot];
  if (light == kNone) return 0;
  const double on_triangle = pdf_triangle(m.triangles[slot], point, on_light);
  if (!(on_triangle > 0)) return 0;
  double total = 0;
  const double share = m.distant_share(point, normal, total);
  const float pdf = float(on_triangle * (1 - share) * m.tree.probability(point, normal, light));
  return pdf < INFINITY ? pdf : 0;
}

float Lights::pdf_environment(Vec3 point, Vec3 normal, Vec3 direction) const {
  if (!(impl_->environment_weight > 0)) return 0;
  double total = 0;
  const double share = impl_->distant_share(point, normal, total);
  const float pdf =
      float(environment_->pdf_solid_angle(direction) * share * impl_->environment_weight / total);
  return pdf < INFINITY ? pdf : 0;
}

Rgb Lights::emitted(const SurfacePoint& hit, Vec3 wo, float width) const {
  const Material& material = impl_->frame->materials[hit.material];
  if (!material.double_sided && !(dot(hit.normal_geometric, wo) > 0)) return Rgb(0.0f);
  if (!material.textures) return material.emission;
  return emission_at(*impl_->frame, hit.surface, hit.triangle, hit.u, hit.v, width);
}

/// Returns the flux of the whole triangle, were it everywhere as bright as where the photon starts.
Rgbd Lights::Impl::emit_triangle(std::size_t slot, const double u[4], PhotonEmission& e) const {
  const TriangleLight& t = triangles[slot];
  // Heitz' map from square to triangle, as sample_triangle, in double.
  double b1 = u[0], b2 = u[1];
  if (b2 > b1)
    b1 *= 0.5, b2 -= b1;
  else
    b2 *= 0.5, b1 -= b2;
  const bool back = t.two_sided && u[2] >= 0.5;
  const double u2 = t.two_sided ? stretch(u[2], back ? 0.5 : 0, 0.5) : u[2];
  e.origin = t.point(b1, b2);
  e.normal = back ? -t.normal : t.normal;
  e.origin_offset = t.offset;
  e.travel = t.area > 0
                 ? normalize(Frame(e.normal).to_world(sample_hemisphere_cos({to_float(u2), to_float(u[3])})))
                 : Vec3{0, 0, 1};
  if (!t.varies) return t.flux();
  TriangleLight here = t;
  here.radiance = emitted_at(slot, b1, b2);
  return here.flux();
}

void Lights::Impl::emit_punctual(const PlacedLight& placed, const double u[4], PhotonEmission& e) const {
  if (placed.light.kind != PunctualLight::Kind::directional) {
    // No position to choose: its two numbers are the direction's.
    e.origin = placed.position;
    e.travel = sample_punctual_direction(placed, u[0], u[1]);
    return;
  }
  const Vec2 disc = sample_disc_concentric({to_float(u[0]), to_float(u[1])});
  const Frame frame_of_light(placed.direction);
  const float r = float(sphere_radius);
  e.travel = placed.direction;
  e.origin = sphere_centre + frame_of_light.to_world({disc.x * r, disc.y * r, -r});
}

/// Returns radiance / density x pi R^2.
Rgbd Lights::Impl::emit_environment(const double u[4], PhotonEmission& e) const {
  EnvironmentLight::Sample from;
  if (!environment->sample(u[0], u[1], from)) {
    e.travel = {0, -1, 0};
    return {};
  }
  const Vec2 disc = sample_disc_concentric({to_float(u[2]), to_float(u[3])});
  const float r = float(sphere_radius);
  e.travel = -from.direction;
  e.origin = sphere_centre + Frame(e.travel).to_world({disc.x * r, disc.y * r, -r});
  return Rgbd(from.radiance) * (disc_area() / from.pdf_solid_angle);
}

PhotonEmission Lights::emit(const double u[4]) const {
  const Impl& m = *impl_;
  TEMPOLUX_CHECK(!m.slots.empty());
  // The first slot whose part of [0, 1) ends beyond u[0]; rounding may leave the sum a little below 1.
  const auto found = std::upper_bound(m.cumulative.begin(), m.cumulative.end(), u[0]);
  std::size_t slot = std::min(std::size_t(found - m.cumulative.begin()), m.slots.size() - 1);
  while (slot > 0 && !(m.slots[slot].probability > 0)) --slot;
  const double below = slot > 0 ? m.cumulative[slot - 1] : 0;
  const double probability = m.slots[slot].probability;
  const double stretched[4] = {stretch(u[0], below, probability), u[1], u[2], u[3]};
  PhotonEmission e;
  e.slot = std::uint32_t(slot);
  Rgbd flux;
  if (slot < m.triangles.size()) {
    flux = m.emit_triangle(slot, stretched, e);
  } else if (m.slots[slot].kind == EmissionSlot::Kind::environment) {
    flux = m.emit_environment(stretched, e);
  } else {
    const PlacedLight& placed = m.frame->lights[m.slots[slot].light];
    flux = punctual_flux(placed.light, m.sphere_radius);
    m.emit_punctual(placed, stretched, e);
  }
  e.flux = Rgb(flux / probability);
  if (!is_finite(e.flux)) refuse_flux(m.frame->scene, max_component(flux));
  return e;
}

}  // namespace tempolux
