// lib/light/lights.cpp -- builds the lights of a frame: slots of the emission table and the light tree.
#include "lib/light/lights.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/core/check.h"
#include "lib/light/closed_parts.h"
#include "lib/scene/texture_lookup.h"

namespace tempolux {

Lights::Lights(const SceneFrame& frame, const EmissionTable& table, Which which)
    : frame_(&frame),
      which_(which),
      environment_(table.environment),
      aim_(table.aim, table.openings, Vec3(table.sphere_centre), table.sphere_radius) {
  if (environment_ && (which == Which::all || which == Which::distant))
    environment_weight_ = max_component(environment_->integral()) / 4;
  add_slots(table);
  build_tree();
}

bool Lights::is_distant(std::size_t slot) const {
  return with(slot, [](const auto& light) { return light.distant(); });
}

bool Lights::shines(std::size_t slot) const {
  switch (which_) {
    case Which::placed: return !is_distant(slot);
    case Which::distant: return is_distant(slot);
    case Which::punctual: return slots_[slot].light != kNone;
    case Which::lamps: return slots_[slot].kind != EmissionSlot::Kind::environment;
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
  double all = which_ == Which::all ? 1 : 0;
  if (which_ != Which::all)
    for (std::size_t i = 0; i < slots_.size(); ++i) all += shines(i) ? table.probability[i] : 0;
  std::vector<double> probability;
  for (std::size_t i = 0; i < slots_.size(); ++i)
    probability.push_back(all > 0 && shines(i) ? table.probability[i] / all : 0);
  set_probabilities(probability);
}

void Lights::set_probabilities(const std::vector<double>& probability) {
  cumulative_.clear();
  photon_flux_.clear();
  double sum = 0;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].probability = probability[i];
    cumulative_.push_back(sum += probability[i]);
    photon_flux_.push_back(Rgb(slot_flux(i) / probability[i]));
  }
}

Lights Lights::placed_alike() const {
  const auto node = [&](std::size_t i) {
    return slots_[i].light == kNone ? frame_->surfaces[slots_[i].surface].node : frame_->lights[slots_[i].light].node;
  };
  const auto is_placed = [&](std::size_t i) { return slots_[i].probability > 0 && !is_distant(i); };
  std::map<std::uint32_t, double> of_node;
  double all = 0;
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (is_placed(i)) of_node[node(i)] += slots_[i].probability, all += slots_[i].probability;
  std::vector<double> probability(slots_.size());
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (is_placed(i)) {
      const double p = slots_[i].probability;
      probability[i] = 0.5 * (p / all + p / (of_node.at(node(i)) * double(of_node.size())));
    }
  Lights alike = *this;
  alike.set_probabilities(probability);
  return alike;
}

Rgbd Lights::slot_flux(std::size_t slot) const {
  return with(slot, [](const auto& light) { return light.flux(); });
}

void Lights::build_tree() {
  tree_index_.assign(slots_.size(), kNone);
  for (std::uint32_t i = 0; i < slots_.size(); ++i) {
    if (!shines(i) || !with(i, [](const auto& light) { return light.emits(); })) continue;
    if (is_distant(i)) {
      if (slots_[i].light != kNone) suns_.push_back(slots_[i].light);
      continue;
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
    const bool two_sided = slot < triangles_.size() && triangles_[slot].two_sided;
    if (two_sided && of.surface != surface) closed = closed_parts(*frame_, of.surface);
    if (two_sided) surface = of.surface;
    bounds.push_back(
        with(slot, [&](const auto& light) { return light.bounds(two_sided ? closed[of.triangle] : Box3()); }));
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
