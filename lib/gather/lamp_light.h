// lib/gather/lamp_light.h -- direct light of lamps close to surfaces: spots smaller than points resolve.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/vec.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A photon of kind direct on a surface close to its lamp.
struct LampPhoton {
  SurfacePoint place;
  Vec3 normal;          ///< unit, geometric, on the lit side
  Bsdf bsdf;            ///< the lobes at the place
  Rgb flux;             ///< W, as photons store it: times |w . n_s| / |w . n|, under a coat times Bsdf::arrival_weight
  float lamp_distance;  ///< m, > 0: distance of the lamp
  /// The irradiance point that represents the place; kNone if there is none, as on the lamp's own fittings.
  std::uint32_t point;
};

/// A lamp at height d above a surface lights a spot with a radius of about d. Points have a spacing s. If d is below
/// this number of spacings, points resolve the spot badly or not at all.
inline constexpr float kBesideLamp = 2;

/// Photons that land within kBesideLamp spacings of their lamp, of 2^15 emitted photons of kind direct (up to 2^18 if
/// fewer than 2^10 land but some do: in sunlight lamps get few photons). The sum of their flux over a place has the
/// direct light of such close lamps as its mean over seeds. Costs one short ray per photon. Same result for any number
/// of threads. `points` may be empty: only its spacing decides which photons land.
std::vector<LampPhoton> photons_beside_lamps(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                                             std::uint64_t seed = 0);

/// The same photons; also marks their points (PointLookup::note_lamp).
std::vector<LampPhoton> note_lamps_beside(const Tracer& tracer, const Lights& lights, PointLookup& points);

}  // namespace tempolux
