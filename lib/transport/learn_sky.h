// lib/transport/learn_sky.h -- finds out in which directions places see the environment.
#pragma once

#include <memory>
#include <span>

#include "lib/light/lights.h"
#include "lib/light/sky_guide.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A place with a Lambert lobe, which will sample lights; or none.
struct SeenPlace {
  SurfacePoint surface;
  Vec3 geometric, normal;  ///< unit, on the side that is seen; zero vectors: there is no place

  bool exists() const { return normal != Vec3{}; }
};

/// Number of places that suffice: where one ray in fifty finds a window their rays make 1300 hits, enough for 10 to 20
/// parts (SkyGuide). Twelve times the rays reduce the variance of a light sample by a further 4 % (docs/pixels.md).
inline constexpr std::size_t kSkyPlaces = 16384;

/// Sends four rays from each place, with the density cos / pi about the shading normal. Null if there is no environment
/// or no part of the places profits from a guide. Same result for any number of threads.
std::shared_ptr<const SkyGuide> learn_sky(const Tracer& tracer, const Lights& lights,
                                          std::span<const SeenPlace> places);

}  // namespace tempolux
