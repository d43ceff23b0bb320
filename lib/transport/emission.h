// lib/transport/emission.h -- emission that a path hits, weighed by MIS against light samples at the path's last
// scattering.
#pragma once

#include "lib/light/lights.h"

namespace tempolux {

/// The last scattering of a path: what MIS needs to weigh emission that the path hits afterwards.
struct LastScatter {
  bool weighed = false;       ///< false after a camera ray or a delta lobe: no light sample could have found the light
  Vec3 position, normal;      ///< normal on the scattered side; zero in a medium
  float pdf_solid_angle = 0;  ///< [1/sr], of the path's direction
  float light_share = 1;      ///< share of the light samples that were drawn for that side
  Lights::From from = Lights::From::all;  ///< the lights that the samples were drawn from
};

/// Radiance [W/m^2/sr] that the surface emits at the hit towards wo, times the power heuristic's weight [Veach 1997,
/// 9.2.4]. Textures are averaged over `width` m. If light samples were drawn at the last scattering, textures are
/// read at their finest level instead, as light samples read them.
Rgb weighed_emission(const Lights& lights, const SurfacePoint& hit, Vec3 wo, const LastScatter& last, float width);

/// The same for the environment, where the path leaves the scene. Needs an environment.
Rgb weighed_environment(const Lights& lights, Vec3 direction, const LastScatter& last);

}  // namespace tempolux
