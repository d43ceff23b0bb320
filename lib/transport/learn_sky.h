// lib/transport/learn_sky.h -- estimates in which directions places see the environment.
#pragma once

#include <memory>
#include <span>

#include "lib/light/lights.h"
#include "lib/light/sky_guide.h"
#include "lib/trace/trace.h"

namespace tempolux {

/// A place at which lights will be sampled; or none.
struct SeenPlace {
  SurfacePoint surface;
  Vec3 geometric, normal;  ///< geometric and shading normal, unit, on the side that is seen; zero if there is no place

  bool exists() const { return normal != Vec3{}; }
};

/// Number of places for a guide. If one ray in fifty finds a window, the first rays of all places make 1300 hits,
/// enough for 10 to 20 parts (SkyGuide). Later rays make more.
inline constexpr std::size_t kSkyPlaces = 16384;

/// Makes a guide from rays and light samples of places, all of which must exist. Each place sends four rays with the
/// pdf cos / pi [1/sr] about the shading normal, up to 64 if some meet the environment but fewer than 96 of all. Then
/// it sends four rays by the grids that the first rays have made, or by the cosine where it has no grid; and four more
/// each time, by the grids of all rays before, if the first rays make fewer hits than one in sixteen places (small
/// windows). It also takes one sample of the lights inside the scene. Null if there is no environment. Same result for
/// any number of threads.
std::shared_ptr<const SkyGuide> learn_sky(const Tracer& tracer, const Lights& lights,
                                          std::span<const SeenPlace> places);

}  // namespace tempolux
