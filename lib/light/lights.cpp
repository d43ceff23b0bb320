// lib/light/lights.cpp -- builds the lights of a frame: slots of the emission table and the light tree.
#include "lib/light/lights.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/light/closed_parts.h"
#include "lib/light/punctual.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {
namespace {

/// `backs_within` is the box around the closed part that holds the triangle; empty if there is none (closed_parts.h).
LightBounds bounds_of(const TriangleLight& t, const Box3& backs_within) {
  LightBounds b;
  b.box.add(t.corner);
  b.box.add(t.corner + t.edge1);
  b.box.add(t.corner + t.edge2);
  b.axis = t.normal;
  b.add_weight(t.normal, double(max_component(t.radiance)) * t.area);
  b.two_sided = t.two_sided && backs_within.empty();
  if (t.two_sided) b.backs_within = backs_within;
  return b;
}

bool is_directional(const PlacedLight& placed) { return placed.light.kind == PunctualLight::Kind::directional; }

LightBounds bounds_of(const PlacedLight& placed) {
  LightBounds b;
  b.box.add(placed.position);
  b.axis = placed.direction;
  b.add_punctual(max_component(placed.light.intensity));
  b.cos_spread = -1;
  if (placed.light.kind == PunctualLight::Kind::spot) {
    // The normals fill the inner cone. A direction of the outer cone's edge makes the angle outer - inner with the
    // closest of them.
    b.cos_spread = std::cos(std::min(placed.light.inner_cone_rad, placed.light.outer_cone_rad));
    b.cos_reach = std::max(0.0f, std::cos(placed.light.outer_cone_rad - std::acos(b.cos_spread)));
  }
  return b;
}

}  // namespace

Lights::Lights(const SceneFrame& frame, const EmissionTable& table, Which which)
    : frame_(&frame),
      which_(which),
      sphere_centre_(Vec3(table.sphere_centre)),
      sphere_radius_(table.sphere_radius),
      environment_(table.environment),
      aim_(table.aim, sphere_centre_, sphere_radius_) {
  if (environment_ && (which == Which::all || which == Which::distant))
    environment_weight_ = max_component(environment_->integral()) / 4;
  add_slots(table);
  build_tree();
}

bool Lights::shines(const EmissionSlot& slot) const {
  const bool distant = slot.kind == EmissionSlot::Kind::environment ||
                       (slot.light != kNone && is_directional(frame_->lights[slot.light]));
  switch (which_) {
    case Which::placed: return !distant;
    case Which::distant: return distant;
    case Which::punctual: return slot.light != kNone;
    default: return true;
  }
}

void Lights::add_slots(const EmissionTable& table) {
  first_slot_.assign(frame_->surfaces.size(), kNone);
  parts_.resize(frame_->surfaces.size());
  for (std::size_t i = 0; i < table.surfaces.size(); ++i) {
    const std::uint32_t s = table.surfaces[i];
    first_slot_[s] = std::uint32_t(slots_.size());
    parts_[s] = table.parts[i];
    const std::vector<TriangleLight> lights = triangle_lights(table, i, *frame_);
    for (const EmissionPart& part : parts_[s]->all())
      slots_.push_back({EmissionSlot::Kind::triangle, s, part.triangle, kNone, 0});
    triangles_.insert(triangles_.end(), lights.begin(), lights.end());
  }
  for (std::uint32_t i = 0; i < frame_->lights.size(); ++i)
    slots_.push_back({EmissionSlot::Kind::punctual, kNone, 0, i, 0});
  if (environment_) slots_.push_back({EmissionSlot::Kind::environment, kNone, 0, kNone, 0});
  TEMPOLUX_CHECK(slots_.size() == table.probability.size());
  double sum = 0, all = which_ == Which::all ? 1 : 0;
  if (which_ != Which::all)
    for (std::size_t i = 0; i < slots_.size(); ++i) all += shines(slots_[i]) ? table.probability[i] : 0;
  cumulative_.reserve(slots_.size());
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].probability = all > 0 && shines(slots_[i]) ? table.probability[i] / all : 0;
    cumulative_.push_back(sum += slots_[i].probability);
    photon_flux_.push_back(Rgb(slot_flux(i) / slots_[i].probability));
  }
}

Rgbd Lights::slot_flux(std::size_t slot) const {
  if (slot < triangles_.size()) return triangles_[slot].flux();
  if (slots_[slot].kind == EmissionSlot::Kind::environment) return environment_->integral() * disc_area();
  return punctual_flux(frame_->lights[slots_[slot].light].light, sphere_radius_);
}

void Lights::build_tree() {
  tree_index_.assign(slots_.size(), kNone);
  for (std::uint32_t i = 0; i < slots_.size(); ++i) {
    if (!shines(slots_[i])) continue;
    if (i < triangles_.size()) {
      if (!triangles_[i].emits()) continue;
    } else {
      if (slots_[i].kind == EmissionSlot::Kind::environment) continue;
      if (!(max_component(frame_->lights[slots_[i].light].light.intensity) > 0)) continue;
      if (is_directional(frame_->lights[slots_[i].light])) {
        suns_.push_back(slots_[i].light);
        continue;
      }
    }
    tree_index_[i] = std::uint32_t(tree_slot_.size());
    tree_slot_.push_back(i);
  }
  tree_ = LightTree(tree_bounds());
}

/// Bounds of all lights in `tree`, in the tree's order.
std::vector<LightBounds> Lights::tree_bounds() const {
  std::vector<LightBounds> bounds;
  bounds.reserve(tree_slot_.size());
  std::uint32_t surface = kNone;
  std::vector<Box3> closed;
  for (const std::uint32_t slot : tree_slot_) {
    const EmissionSlot& of = slots_[slot];
    if (slot >= triangles_.size()) {
      bounds.push_back(bounds_of(frame_->lights[of.light]));
      continue;
    }
    if (of.surface != surface && triangles_[slot].two_sided) closed = closed_parts(*frame_, of.surface);
    surface = of.surface;
    bounds.push_back(bounds_of(triangles_[slot], triangles_[slot].two_sided ? closed[of.triangle] : Box3()));
  }
  return bounds;
}

Rgbd Lights::total_flux() const {
  Rgbd sum;
  for (std::size_t slot = 0; slot < count(); ++slot) sum += slot_flux(slot);
  return sum;
}

Rgb Lights::emitted(const SurfacePoint& hit, Vec3 wo, float width) const {
  if (which_ == Which::distant || which_ == Which::punctual) return Rgb(0.0f);
  const Material& material = frame_->materials[hit.material];
  if (!material.double_sided && !(dot(hit.normal_geometric, wo) > 0)) return Rgb(0.0f);
  if (!material.textures) return material.emission;
  return emission_at(*frame_, hit.surface, hit.triangle, hit.u, hit.v, width);
}

}  // namespace tempolux
