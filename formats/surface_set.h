// formats/surface_set.h -- whether a point or record belongs to the static scene or to movers.
#pragma once

#include <cstdint>

namespace tempolux::formats {

/// static_set: the surface does not move in the segment. dynamic_set: the surface moves, or the record was computed
/// again for this frame because movers change its light.
enum class SurfaceSet : std::uint8_t { static_set = 0, dynamic_set = 1 };

}  // namespace tempolux::formats
