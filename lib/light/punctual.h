// lib/light/punctual.h -- point, spot and directional lights of KHR_lights_punctual: falloff, flux, photons.
#pragma once

#include "lib/core/vec.h"
#include "lib/scene/at_frame.h"

namespace tempolux {

/// Intensity of a spot over the angle t from its axis: I for 1 - cos t <= inner, I s^2 beyond, with
/// s = (cos t - cos outer) / (cos inner - cos outer) clamped to [0, 1]: the falloff that KHR_lights_punctual
/// gives, but for its floor of 0.001 under the denominator, which would dim the axis of cones below 2.6
/// degrees. Angles are held as 1 - cos, which keeps its digits for narrow cones.
struct SpotProfile {
  double inner = 0, outer = 0;  ///< 1 - cos of the half angles, inner <= outer

  explicit SpotProfile(const PunctualLight& light);
  /// s^2 [1] at one_minus_cos = 1 - cos t.
  double falloff(double one_minus_cos) const;
  /// Integral of s^2 over the sphere [sr]: 2 pi (inner + (outer - inner) / 3).
  double solid_angle() const;
  /// 1 - cos t, distributed as the light the spot emits; u in [0, 1), 0 is the axis.
  double sample_one_minus_cos(double u) const;
};

/// Flux [W] of a light; of a directional one through a disc of this radius [m].
Rgbd punctual_flux(const PunctualLight& light, double disc_radius);

/// Unit direction in which a point or spot light sends the photon (u1, u2), density in proportion to its
/// intensity: uniform over the sphere for a point light.
Vec3 sample_punctual_direction(const PlacedLight& placed, double u1, double u2);

}  // namespace tempolux
