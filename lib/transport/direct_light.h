// lib/transport/direct_light.h -- draws one light sample for a surface.
#pragma once

#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// The side of a surface that receives light.
struct Receiver {
  const SurfacePoint& place;
  Vec3 geometric, shading;     ///< unit, on the lit side
  const Bsdf* coat = nullptr;  ///< Bsdf of a Lambert lobe under a coat, for its arrival_weight(); null: no coat
};

/// One sample of the light that reaches a receiver.
struct DirectSample {
  LightSample light;
  /// Estimate of the unshadowed irradiance [W/m^2] with the cosine to the shading normal; under a coat, times
  /// Bsdf::arrival_weight.
  Rgb irradiance{0.0f};
  Ray shadow;  ///< shadow ray: transmittance() along it is the share of the light that arrives
};

/// Draws a light by u_choice and a point on it by u, all in [0, 1) (Lights::sample). False if no light can reach the
/// receiver, or if the light comes from behind the geometric or the shading normal; the sample then counts as 0.
bool sample_direct(const Lights& lights, const Receiver& at, float u_choice, Vec2 u, DirectSample& sample);
/// The same for all lights but the directional ones. u chooses the light and the point.
bool sample_other_than_suns(const Lights& lights, const Receiver& at, Vec2 u, DirectSample& sample);
/// The same for the directional lights.
bool sample_sun(const Lights& lights, const Receiver& at, Vec2 u, DirectSample& sample);

}  // namespace tempolux
