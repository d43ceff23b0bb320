// lib/material/smooth_material.h -- finds materials that reflect or transmit light only by mirrors and smooth glass.
#pragma once

#include <cstdint>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Index of the first material in use whose S lobes are all mirrors or smooth glass; kNone if there is none. Textures
/// are ignored, so a material that they make smooth in parts may be missed.
std::uint32_t first_smooth_material(const SceneFrame& frame);

}  // namespace tempolux
