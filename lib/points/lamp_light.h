// lib/points/lamp_light.h -- direct light of lamps close to surfaces: spots smaller than points resolve.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/vec.h"
#include "lib/irradcache/points.h"
#include "lib/light/lights.h"
#include "lib/material/bsdf.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A photon of kind direct that lands on a surface close to its lamp.
struct LampPhoton {
  SurfacePoint place;
  Vec3 normal;  ///< unit, geometric, on the lit side
  Bsdf bsdf;    ///< the lobes at the place
  /// W, as photons store it: arriving flux x |wi . n_s| / |wi . n|, under a coat times Bsdf::arrival_weight
  Rgb flux;
  Rgb arriving;         ///< W: the same without Bsdf::arrival_weight, for the lobes S
  Vec3 wi;              ///< unit, towards the lamp
  float lamp_distance;  ///< m, > 0: distance of the lamp
  /// Index of the irradiance point that represents the place; kNone if no point does, as on the lamp's own fittings.
  std::uint32_t point;
};

/// A lamp at height d above a surface lights a spot with a radius of about d. A point represents hits up to
/// PointLookup::kReach spacings away, so if d is below this number of spacings, points do not resolve the spot.
inline constexpr float kBesideLamp = PointLookup::kReach;

/// Emits 2^15 photons of kind direct and returns those that land within kBesideLamp spacings of their lamp. If fewer
/// than 2^10 land but some do, emits up to 2^18. Every lamp gets photons (Lights::placed_alike), also beside a sun:
/// else gather rays would leave out light that no photon brings. The sum of the photons' flux over an area, in the mean
/// over seeds, is the flux that the area receives from such close lamps. Costs one short ray per photon. Same result
/// for any number of threads. `points` may be empty; its spacing decides which photons land.
std::vector<LampPhoton> photons_beside_lamps(const Tracer& tracer, const Lights& lights, const PointLookup& points,
                                             std::uint64_t seed = 0);

/// The same photons. Also marks their points (PointLookup::note_lamp).
std::vector<LampPhoton> note_lamps_beside(const Tracer& tracer, const Lights& lights, PointLookup& points);

}  // namespace tempolux
