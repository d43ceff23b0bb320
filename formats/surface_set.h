// formats/surface_set.h -- whether a point or record lies on what stands still.
#pragma once

#include <cstdint>

namespace tempolux::formats {

/// static_set: on a surface that does not move in the segment; dynamic_set: on one that moves, or recomputed
/// for this frame because what moves matters there.
enum class SurfaceSet : std::uint8_t { static_set = 0, dynamic_set = 1 };

}  // namespace tempolux::formats
