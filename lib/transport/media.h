// lib/transport/media.h -- what paths from the eye do in media: collide, gather light from lamps, go on.
#pragma once

#include "lib/core/random.h"
#include "lib/light/lights.h"
#include "lib/trace/trace.h"
#include "lib/volume/flight.h"
#include "lib/volume/medium.h"
#include "lib/volume/phase.h"

namespace tempolux {

/// Random bits of the steps of one way: `random` and `bounce` are the path's, `way` tells the ways of one bounce apart.
struct WayBits {
  PathRandom random;
  std::uint32_t bounce, way;
  std::uint64_t operator()(std::uint32_t step) const {
    return random.bits(bounce, Purpose::flight, way << 20 | (step & 0xfffff));
  }
};
enum Way : std::uint32_t { way_path = 0, way_shadow = 1, way_shadow_of_medium = 2 };  ///< < 16

/// Share of light left on a ray whose direction need not be unit, by media alone: an estimate (estimate_transmittance).
float media_transmittance(const Media& media, const Ray& ray, const WayBits& bits);

/// The same for a ray between a point and a light; 0 where a surface is in the way. Without media exactly 0 or 1. This
/// is what shadow rays ask.
float transmittance(const Tracer& tracer, const Ray& ray, const WayBits& bits);

/// A collision with a medium: where the path is scattered next.
struct MediumPoint {
  Vec3 position, travel;  ///< travel: direction of flight before it, seen along the path from the eye; unit
  Rgb albedo;
  float g;
};

/// Where the path along the ray (unit direction) collides before t = end; false if it does not.
bool collides(const Media& media, const Ray& ray, float end, const PathRandom& random, std::uint32_t bounce,
              MediumPoint& point);

/// Light of a sampled lamp scattered at the point towards where the path came from, shadows and transmittance included:
/// radiance [W/m^2/sr], albedo not. `weigh`: by the power heuristic against scattering, for paths that go on and may
/// hit the lamp. `u`: chooses lamp and place on it. Counts a shadow ray if one is traced.
Rgb scattered_lamp_light(const Tracer& tracer, const Lights& lights, const MediumPoint& point, Vec2 u, bool weigh,
                         const WayBits& bits, std::uint64_t& shadow_rays);

}  // namespace tempolux
