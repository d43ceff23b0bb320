// lib/transport/emission.h -- emission that a path hits, weighed by MIS against light samples at the path's last
// scattering.
#pragma once

#include "lib/light/lights.h"

namespace tempolux {

/// The vertex at which a path was scattered last. MIS weighs emission that the path hits afterwards by it.
struct LastScatter {
  bool weighed = false;       ///< false for a camera ray and after a delta lobe: no light sample finds the emission
  Vec3 position, normal;      ///< scene space; unit normal on the side that the path leaves to; zero in a medium
  float pdf_solid_angle = 0;  ///< pdf of the path's direction [1/sr]
  float light_share = 1;      ///< probability that a light sample was drawn on that side
  Lights::From from = Lights::From::all;  ///< the lights among which light samples were drawn
};

/// Radiance [W/m^2/sr] that the surface emits at the hit towards wo (unit), times the weight of the power heuristic
/// [Veach 1997, 9.2.4]. Textures are averaged over `width` m; but if last.weighed, they are read at their finest level,
/// as light samples read them.
Rgb weighed_emission(const Lights& lights, const SurfacePoint& hit, Vec3 wo, const LastScatter& last, float width);

/// The same for the environment in this direction (unit, in which the path leaves the scene). Needs an environment.
Rgb weighed_environment(const Lights& lights, Vec3 direction, const LastScatter& last);

}  // namespace tempolux
