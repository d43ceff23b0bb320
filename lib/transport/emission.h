// lib/transport/emission.h -- light that a path meets, weighed against light samples where the path was scattered
// before.
#pragma once

#include "lib/light/lights.h"

namespace tempolux {

/// The last scattering of a path: what a hit on a light must know to be weighed.
struct LastScatter {
  bool weighed = false;                   ///< false: camera ray or delta lobe, light sampling could not find the light
  Vec3 position, normal;                  ///< normal on the side that was scattered to; zero in a medium
  float pdf_solid_angle = 0;              ///< [1/sr] of the direction that was taken
  float light_share = 1;                  ///< of light samples that were aimed at that side
  Lights::From from = Lights::From::all;  ///< lights that samples were drawn from there
};

/// Radiance [W/m^2/sr] that the surface emits at the hit towards wo, times the weight of the power heuristic [Veach
/// 1997, 9.2.4]. Textures are read over `width` m, but at their finest level where light samples could have found the
/// light: both read the same.
Rgb weighed_emission(const Lights& lights, const SurfacePoint& hit, Vec3 wo, const LastScatter& last, float width);

/// The same of the environment, where the path leaves the scene; only with one.
Rgb weighed_environment(const Lights& lights, Vec3 direction, const LastScatter& last);

}  // namespace tempolux
