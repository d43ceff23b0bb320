// lib/gather/lamp_light.h -- light that lamps throw on surfaces beside them: spots smaller than points can hold.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/vec.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A photon of kind direct on a surface near its lamp.
struct LampPhoton {
  SurfacePoint place;
  Vec3 normal;  ///< unit, geometric, on the lit side
  Bsdf bsdf;    ///< the lobes there
  Rgb flux;     ///< W, as photons are stored: times |w . n_s| / |w . n|, under a coat times Bsdf::arrival_weight
  float lamp_distance;  ///< m, > 0
  std::uint32_t
      point;  ///< the irradiance point that stands for the place; kNone: none does, as on the lamp's own fittings
};

/// A lamp at the height d above a surface lights a spot of about the radius d. Points lie a spacing s apart: of a lamp
/// nearer than this many spacings they know the spot badly or, as a rule, not at all.
inline constexpr float kBesideLamp = 2;

/// Of 2^15 photons of kind direct from all lamps (up to 2^18 where fewer than 2^10 land, but some do: under a sun a
/// lamp has few) those that land within kBesideLamp spacings of their lamp. The sum of their flux over a place is the
/// direct light that comes from so near, in the mean over seeds. Costs a ray of that length for each. Same result for
/// any number of threads.
std::vector<LampPhoton> photons_beside_lamps(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                                             std::uint64_t seed = 0);

/// The same; their points are noted (PointLookup::note_lamp).
std::vector<LampPhoton> note_lamps_beside(const Tracer& tracer, const Lights& lights, PointLookup& points);

}  // namespace tempolux
