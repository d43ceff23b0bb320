// lib/transport/media.h -- participating media along camera paths: transmittance, collisions, scattered light.
#pragma once

#include "lib/core/random.h"
#include "lib/light/lights.h"
#include "lib/trace/trace.h"
#include "lib/volume/flight.h"
#include "lib/volume/medium.h"
#include "lib/volume/phase.h"

namespace tempolux {

/// Random bits for the steps along one ray. `random` and `bounce` identify the vertex of the path from which the ray
/// starts; `way` distinguishes the rays of one vertex (enum Way).
struct WayBits {
  PathRandom random;
  std::uint32_t bounce, way;  ///< way: below 16
  /// 64 bits for a step (modulo 2^20).
  std::uint64_t operator()(std::uint32_t step) const {
    return random.bits(bounce, Purpose::flight, way << 20 | (step & 0xfffff));
  }
};
enum Way : std::uint32_t { way_path = 0, way_shadow = 1, way_shadow_of_medium = 2 };

/// Unbiased estimate in [0, 1] of the transmittance of the media along a ray in scene space (estimate_transmittance).
/// The direction need not be unit. 1 for a direction of length 0.
float media_transmittance(const Media& media, const Ray& ray, const WayBits& bits);

/// Share of light that goes straight through a surface (Bsdf::passed_straight). `direction`: of the ray, of any length.
/// Black unless the surface is a pane or bounds a plate.
Rgb passed_straight(const SceneFrame& frame, SurfacePoint point, Vec3 direction);

/// Share of light that arrives along a shadow ray: media_transmittance() times passed_straight() of each pane and
/// plate on the way. Black if another surface is in the way. Without media, panes and plates the result is exactly 0
/// or 1.
Rgb transmittance(const Tracer& tracer, const Ray& ray, const WayBits& bits);

/// A collision with a medium, where the path is scattered.
struct MediumPoint {
  Vec3 position;  ///< scene space
  Vec3 travel;    ///< unit direction in which the path from the camera arrives
  Rgb albedo;     ///< single-scattering albedo
  float g;        ///< mean cosine of the phase function
};

/// Draws the first collision with a medium along the ray (unit direction) before t = end [m] and sets `point`; false if
/// there is none.
bool collides(const Media& media, const Ray& ray, float end, const PathRandom& random, std::uint32_t bounce,
              MediumPoint& point);

/// How a light sample is drawn and counts.
struct LampDraw {
  Vec2 u;      ///< chooses the light and the point on it
  bool weigh;  ///< weigh the sample by the power heuristic against scattering: the path continues and may hit the light
  WayBits bits;  ///< for the transmittance of the shadow ray
};

/// Radiance [W/m^2/sr] of a light sample that the point scatters back along the path, with shadows and transmittance
/// but without albedo. Adds 1 to shadow_rays if a shadow ray is traced.
Rgb scattered_lamp_light(const Tracer& tracer, const Lights& lights, const MediumPoint& point, const LampDraw& draw,
                         std::uint64_t& shadow_rays);

}  // namespace tempolux
