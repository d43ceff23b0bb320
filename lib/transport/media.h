// lib/transport/media.h -- participating media along paths from the eye: transmittance, collisions, scattered light.
#pragma once

#include "lib/core/random.h"
#include "lib/light/lights.h"
#include "lib/trace/trace.h"
#include "lib/volume/flight.h"
#include "lib/volume/medium.h"
#include "lib/volume/phase.h"

namespace tempolux {

/// Keys of the random numbers along one ray: `random` and `bounce` belong to the path, `way` distinguishes the rays of
/// one bounce.
struct WayBits {
  PathRandom random;
  std::uint32_t bounce, way;
  std::uint64_t operator()(std::uint32_t step) const {
    return random.bits(bounce, Purpose::flight, way << 20 | (step & 0xfffff));
  }
};
enum Way : std::uint32_t { way_path = 0, way_shadow = 1, way_shadow_of_medium = 2 };  ///< < 16

/// Estimate of the transmittance of the media along a ray (estimate_transmittance). The direction need not be unit.
float media_transmittance(const Media& media, const Ray& ray, const WayBits& bits);

/// Share of light that goes straight through a surface along `direction`, of any length (Bsdf::passed_straight).
Rgb passed_straight(const SceneFrame& frame, SurfacePoint point, Vec3 direction);

/// Share of light that arrives along a shadow ray: that of the media, times that of each pane on the way. Black if
/// another surface is in the way. Without media and panes the result is exactly 0 or 1.
Rgb transmittance(const Tracer& tracer, const Ray& ray, const WayBits& bits);

/// A collision with a medium, where the path is scattered.
struct MediumPoint {
  Vec3 position, travel;  ///< travel: unit direction of the path before the collision, away from the eye
  Rgb albedo;
  float g;
};

/// Draws the collision of the path along the ray (unit direction) with a medium before t = end; false if there is none.
bool collides(const Media& media, const Ray& ray, float end, const PathRandom& random, std::uint32_t bounce,
              MediumPoint& point);

/// Radiance [W/m^2/sr] of a sampled light that the point scatters back along the path, with shadows and transmittance
/// but without albedo. `weigh`: weigh by the power heuristic against scattering, for paths that go on and may hit the
/// light. `u` chooses the light and the point on it. Counts a shadow ray if one is traced.
Rgb scattered_lamp_light(const Tracer& tracer, const Lights& lights, const MediumPoint& point, Vec2 u, bool weigh,
                         const WayBits& bits, std::uint64_t& shadow_rays);

}  // namespace tempolux
