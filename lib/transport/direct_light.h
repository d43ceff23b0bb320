// lib/transport/direct_light.h -- one sample of the lights at a place.
#pragma once

#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A side of a surface that light arrives at.
struct Receiver {
  const SurfacePoint& place;
  Vec3 geometric, shading;  ///< normals, unit, on the lit side
  const Bsdf* coat =
      nullptr;  ///< the lobes there, if they weigh light by the angle it arrives at (Bsdf::arrival_weight)
};

/// A sample of the lights that can reach a receiver.
struct DirectSample {
  LightSample light;
  Rgb irradiance{0.0f};  ///< W/m^2 over the density of the sample, if nothing is in the way: by the cosine to the
                         ///< shading normal, times Bsdf::arrival_weight under a coat
  Ray shadow;  ///< transmittance() of it is the share that arrives
};

/// Draws a light and a place on it (Lights::sample). False if none can reach the receiver, or the light comes from
/// behind either of its normals.
bool sample_direct(const Lights& lights, const Receiver& at, float u_choice, Vec2 u, DirectSample& sample);
/// The same from one stratified pair.
bool sample_direct(const Lights& lights, const Receiver& at, Vec2 u, DirectSample& sample);

}  // namespace tempolux
