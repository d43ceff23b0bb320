// lib/light/lights_impl.h -- the data behind Lights, shared by lights.cpp (building), light_sampling.cpp (light
// samples) and photon_emission.cpp (photons).
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "lib/core/sampling.h"
#include "lib/light/light_tree.h"
#include "lib/light/lights.h"
#include "lib/light/triangle_light.h"

namespace tempolux {

struct Lights::Impl {
  /// As Lights::sample. `joint`: u_choice is u.x, so the remainder of the choice replaces u.x.
  bool sample(Vec3 point, Vec3 normal, float u_choice, Vec2 u, bool joint, From from, LightSample& sample) const;
  const SceneFrame* frame;
  Which which;
  Vec3 sphere_centre;
  double sphere_radius;
  std::vector<EmissionSlot> slots;
  std::vector<TriangleLight> triangles;   // of the first slots, in the same order
  std::vector<double> cumulative;         // cumulative probability, by slot
  std::vector<Rgb> photon_flux;           // by slot: flux / probability, if all photons of the slot carry the same flux
  std::vector<std::uint32_t> first_slot;  // first slot of each surface; kNone: the surface emits nothing
  std::vector<std::uint32_t> tree_index;  // by slot: number of its light in the tree; kNone: the slot emits nothing
  std::vector<std::uint32_t> tree_slot;   // and back
  std::vector<std::uint32_t> suns;        // indices of the directional lights that shine
  std::shared_ptr<const EnvironmentLight> environment;
  double environment_weight = 0;  // irradiance from the environment, averaged over all normals; 0: none or black
  Aim aim;                        // of photons from directional lights and environment
  bool any_distant = false;       // true if the environment is not black or a directional light shines
  LightTree tree{{}};
  Impl(const SceneFrame& frame_, const EmissionTable& table, Which which_);
  bool shines(const EmissionSlot& slot) const;
  void add_slots(const EmissionTable& table);
  void build_tree();

  Rgbd slot_flux(std::size_t slot) const;  ///< W
  std::vector<LightBounds> tree_bounds() const;
  bool sample_tree(const LightTree::Start& start, double probability, Vec3 point, Vec3 normal, float u_choice, Vec2 u,
                   bool joint, LightSample& sample) const;
  bool sample_sun(Vec3 point, Vec3 normal, double u, double probability, LightSample& s) const;
  double sum_distant(Vec3 normal) const;
  double distant_irradiance(Vec3 normal, From from) const {
    return !any_distant ? 0 : from == From::all ? sum_distant(normal) : environment_weight;
  }
  double distant_share(Vec3 point, Vec3 normal, From from, double& total) const;
  bool sample_slot(std::uint32_t slot, Vec3 point, double probability, double left, Vec2 u, bool joint,
                   LightSample& sample) const;
  bool sample_distant(Vec3 point, Vec3 normal, Vec2 u_float, double u, double share, double total,
                      LightSample& s) const;
  bool sample_environment(Vec3 point, Vec2 u_float, double u, double probability, LightSample& s) const;
  double disc_area() const { return std::numbers::pi * sphere_radius * sphere_radius; }
  float distance_beyond() const { return float(sphere_radius > 0 ? 2 * sphere_radius : 1); }
  bool sample_placed(const PlacedLight& placed, Vec3 point, double probability, LightSample& s) const;
  /// Radiance of a point on a slot's triangle, by barycentric coordinates.
  Rgb emitted_at(std::size_t slot, double b1, double b2) const {
    return triangles[slot].emitted_at(*frame, slots[slot].surface, slots[slot].triangle, b1, b2);
  }
  std::size_t slot_at(double u) const;
  Vec2 direction_numbers(std::size_t slot, const std::array<double, 4>& u) const;
  void emit_triangle(std::size_t slot, double u0, const std::array<double, 4>& u, Vec3 direction,
                     PhotonEmission& e) const;
  void emit_environment(std::size_t slot, double u0, const std::array<double, 4>& u, PhotonEmission& e) const;
  void emit_punctual(const PlacedLight& placed, double u0, const std::array<double, 4>& u, PhotonEmission& e) const;
};

/// Maps u from the part [first, first + width) of [0, 1) to [0, 1).
inline double stretch(double u, double first, double width) {
  return std::clamp((u - first) / width, 0.0, 1 - 0x1p-53);
}
inline float to_float(double u) { return std::min(float(u), kOneMinusEpsilon); }

}  // namespace tempolux
