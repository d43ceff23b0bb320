// lib/light/lights.cpp -- builds the lights of a frame: slots of the emission table and the light tree.
#include "lib/light/lights.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/light/lights_impl.h"
#include "lib/light/punctual.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

EmissionSlot::Kind slot_kind(PunctualLight::Kind kind) {
  switch (kind) {
    case PunctualLight::Kind::point: return EmissionSlot::Kind::point;
    case PunctualLight::Kind::spot: return EmissionSlot::Kind::spot;
    case PunctualLight::Kind::directional: return EmissionSlot::Kind::directional;
  }
  return EmissionSlot::Kind::point;
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
    // The spot's axis is the only normal; light reaches as far as the outer cone.
    b.cos_spread = std::cos(std::min(placed.light.inner_cone_rad, placed.light.outer_cone_rad));
    b.cos_reach = std::max(0.0f, std::cos(placed.light.outer_cone_rad - std::acos(b.cos_spread)));
  }
  return b;
}

}  // namespace

Lights::Impl::Impl(const SceneFrame& frame_, const EmissionTable& table)
    : frame(&frame_),
      sphere_centre(Vec3(table.sphere_centre)),
      sphere_radius(table.sphere_radius),
      environment(table.environment),
      aim(table.aim, sphere_centre, sphere_radius) {
  if (environment) environment_weight = max_component(environment->integral()) / 4;
  add_slots(table);
  build_tree();
}

void Lights::Impl::add_slots(const EmissionTable& table) {
  first_slot.assign(frame->surfaces.size(), kNone);
  for (std::size_t i = 0; i < table.surfaces.size(); ++i) {
    const std::uint32_t s = table.surfaces[i];
    first_slot[s] = std::uint32_t(slots.size());
    const std::vector<TriangleLight> lights = triangle_lights(table, i, *frame);
    for (std::uint32_t t = 0; t < lights.size(); ++t) slots.push_back({EmissionSlot::Kind::triangle, s, t, kNone, 0});
    triangles.insert(triangles.end(), lights.begin(), lights.end());
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
    photon_flux.push_back(Rgb(slot_flux(i) / table.probability[i]));
  }
}

Rgbd Lights::Impl::slot_flux(std::size_t slot) const {
  if (slot < triangles.size()) return triangles[slot].flux();
  if (slots[slot].kind == EmissionSlot::Kind::environment) return environment->integral() * disc_area();
  return punctual_flux(frame->lights[slots[slot].light].light, sphere_radius);
}

void Lights::Impl::build_tree() {
  tree_index.assign(slots.size(), kNone);
  for (std::uint32_t i = 0; i < slots.size(); ++i) {
    if (i < triangles.size()) {
      if (!triangles[i].emits()) continue;
    } else {
      if (slots[i].kind == EmissionSlot::Kind::environment) continue;
      if (!(max_component(frame->lights[slots[i].light].light.intensity) > 0)) continue;
      if (slots[i].kind == EmissionSlot::Kind::directional) {
        suns.push_back(slots[i].light);
        continue;
      }
    }
    tree_index[i] = std::uint32_t(tree_slot.size());
    tree_slot.push_back(i);
  }
  any_distant = environment_weight > 0 || !suns.empty();
  tree = LightTree(tree_bounds());
}

/// Bounds of all lights in `tree`, in the tree's order.
std::vector<LightBounds> Lights::Impl::tree_bounds() const {
  std::vector<LightBounds> bounds;
  bounds.reserve(tree_slot.size());
  for (const std::uint32_t slot : tree_slot)
    bounds.push_back(slot < triangles.size() ? bounds_of(triangles[slot])
                                             : bounds_of(frame->lights[slots[slot].light]));
  return bounds;
}

Lights::Lights(const SceneFrame& frame, const EmissionTable& table)
    : impl_(std::make_unique<Impl>(frame, table)), environment_(impl_->environment.get()) {}
Lights::~Lights() = default;
Lights::Lights(Lights&&) noexcept = default;

bool Lights::has_distant() const { return impl_->any_distant; }
bool Lights::has_placed() const { return !impl_->tree.empty(); }

bool Lights::empty() const { return impl_->slots.empty(); }
std::size_t Lights::count() const { return impl_->slots.size(); }
const std::vector<EmissionSlot>& Lights::slots() const { return impl_->slots; }
const Aim& Lights::aim() const { return impl_->aim; }

Rgbd Lights::total_flux() const {
  Rgbd sum;
  for (std::size_t slot = 0; slot < count(); ++slot) sum += impl_->slot_flux(slot);
  return sum;
}

Rgb Lights::emitted(const SurfacePoint& hit, Vec3 wo, float width) const {
  const Material& material = impl_->frame->materials[hit.material];
  if (!material.double_sided && !(dot(hit.normal_geometric, wo) > 0)) return Rgb(0.0f);
  if (!material.textures) return material.emission;
  return emission_at(*impl_->frame, hit.surface, hit.triangle, hit.u, hit.v, width);
}

}  // namespace tempolux
