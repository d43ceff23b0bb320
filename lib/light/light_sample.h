// lib/light/light_sample.h -- what every kind of light gives: a sample for a point, and a photon.
//
// TriangleLight, PunctualSource and SkySource are the kinds of lights. Each has the same functions: flux(), emits(),
// distant(), bounds() for the light tree, sample() from a place, pdf_solid_angle() of a sample where a ray can meet the
// light, and emit(). Lights chooses among lights and knows their kinds in one function, Lights::with().
#pragma once

#include <cstdint>

#include "lib/core/vec.h"

namespace tempolux {

/// A place or direction of a light that was drawn for a point.
struct LightSample {
  Vec3 wi{};        ///< unit, from the point towards the light
  Vec3 position{};  ///< on the light, on its nearer side; outside the scene for directional lights and the environment
  float position_offset = 0;  ///< m; the shadow ray ends this far before `position`
  /// W/m^2 on a surface that faces wi: radiance / pdf; for a light without size I / (d^2 P) or E / P, where P is the
  /// probability of choosing the light. Multiplied by f cos it gives reflected radiance.
  Rgb facing_irradiance{0.0f};
  float pdf_solid_angle = 0;  ///< [1/sr], includes the choice of the light; 0 if `only_sampled`
  /// True for point, spot and directional lights. No ray meets these lights, whatever their size. So their samples
  /// count in full, without a MIS weight.
  bool only_sampled = false;
  bool distant = false;  ///< true for the environment and directional lights
};

/// A photon at its light.
struct PhotonEmission {
  Vec3 origin{}, travel{};  ///< scene space, m; unit direction of flight
  float origin_offset = 0;  ///< m; the photon starts this far along the emitting side's normal
  Vec3 normal{};            ///< unit normal of the emitting side; zero for distant lights and lights without size
  /// m; above 0 for a lamp that is a sphere, whose far side lies this far behind `origin`. If surfaces lie on this
  /// chord, the lamp lights them as well, with a second photon of this flux that starts at the far side and ends here.
  float chord = 0;
  Rgb flux{0.0f};  ///< W, of one photon if one photon is emitted: the caller divides by the number of photons
  std::uint32_t slot = 0;
};

}  // namespace tempolux
