// lib/light/punctual.h -- point, spot and directional lights of KHR_lights_punctual: falloff, flux and emission of
// photons.
#pragma once

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Intensity of a spot at angle t from its axis: I inside the inner cone; I s^2 outside, with s = (cos t - cos outer) /
/// (cos inner - cos outer), clamped to [0, 1]. This is the falloff of KHR_lights_punctual without its floor of 0.001 in
/// the denominator, which would dim the axis of cones narrower than 2.6 degrees. Angles are held as 1 - cos, which
/// keeps its digits for narrow cones.
struct SpotProfile {
  double inner = 0, outer = 0;  ///< 1 - cos of the half angles; inner <= outer

  /// The profile of a light of kind spot.
  explicit SpotProfile(const PunctualLight& light);
  /// s^2 [1] at one_minus_cos = 1 - cos t.
  double falloff(double one_minus_cos) const;
  /// Integral of s^2 over the sphere [sr]: 2 pi (inner + (outer - inner) / 3).
  double solid_angle() const;
  /// Draws 1 - cos t in proportion to the emitted light; u in [0, 1), where 0 is the axis.
  double sample_one_minus_cos(double u) const;
};

/// Flux [W] of a light. A directional light's flux is that through a disc of this radius [m].
Rgbd punctual_flux(const PunctualLight& light, double disc_radius);

/// Unit direction in which a point or spot light emits a photon, from u1 and u2 in [0, 1). The pdf is in proportion to
/// intensity: uniform over the sphere for a point light.
Vec3 sample_punctual_direction(const PlacedLight& placed, double u1, double u2);

}  // namespace tempolux
