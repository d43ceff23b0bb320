// lib/transport/direct_light.h -- draws one light sample for a surface.
#pragma once

#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// One side of a surface, which receives light.
struct Receiver {
  const SurfacePoint& place;
  Vec3 geometric, shading;     ///< unit, on the lit side
  const Bsdf* coat = nullptr;  ///< set if the lobes weigh light by its angle of arrival (Bsdf::arrival_weight)
};

/// One sample of the lights that can reach a receiver.
struct DirectSample {
  LightSample light;
  /// Estimate of the unshadowed irradiance by the cosine to the shading normal [W/m^2], times Bsdf::arrival_weight
  /// under a coat.
  Rgb irradiance{0.0f};
  Ray shadow;  ///< its transmittance() is the share of the light that arrives
};

/// Draws a light and a point on it (Lights::sample). False if no light can reach the receiver, or the light comes from
/// behind its geometric or its shading normal.
bool sample_direct(const Lights& lights, const Receiver& at, float u_choice, Vec2 u, DirectSample& sample);
/// The same among all but the directional lights, from one stratified pair, and among the directional lights.
bool sample_other_than_suns(const Lights& lights, const Receiver& at, Vec2 u, DirectSample& sample);
bool sample_sun(const Lights& lights, const Receiver& at, float u, DirectSample& sample);

}  // namespace tempolux
