// lib/light/sky_source.h -- the environment as one of the kinds of lights (light_sample.h).
#pragma once

#include <array>

#include "lib/light/aim.h"
#include "lib/light/environment_light.h"
#include "lib/light/light_sample.h"
#include "lib/light/light_tree.h"
#include "lib/light/sky_guide.h"

namespace tempolux {

/// The environment around the scene sphere.
struct SkySource {
  const EnvironmentLight& map;
  const Aim& aim;                        ///< where its photons start; also holds the radius of the scene sphere
  const SkyGuide::Grid* grid = nullptr;  ///< of the part that holds the point; null: none

  static constexpr bool emits() { return true; }
  static constexpr bool distant() { return true; }
  /// Not used: distant lights are not in the light tree.
  static LightBounds bounds(const Box3&) { return {}; }
  /// Flux [W] through the scene sphere's disc from all directions.
  Rgbd flux() const { return map.integral() * aim.disc_area(); }
  /// Draws a direction for a point by radiance, or from the grid. u is in [0, 1) and was stretched from u_float.x,
  /// which has 24 random bits. `probability`: of choosing the environment. False if no light comes from the direction.
  bool sample(Vec3 point, double probability, double u, Vec2 u_float, LightSample& s) const;
  /// pdf [1/sr] of a direction (unit), whose place is `place`, given that the environment is chosen.
  double pdf_solid_angle(const EnvironmentLight::Place& place, Vec3 direction) const;
  /// Emits a photon of a slot with this probability: u0 and u[1] give the direction, u[2] and u[3] the start.
  void emit(double u0, const std::array<double, 4>& u, double probability, PhotonEmission& e) const;
};

/// Sets the start and the flux of a photon of distant light that flies along e.travel. The start is drawn by aim.
/// `flux` [W]: flux of a photon whose start is uniform on the scene sphere's disc.
void start_distant(const Aim& aim, double u, double v, Rgbd flux, PhotonEmission& e);

}  // namespace tempolux
