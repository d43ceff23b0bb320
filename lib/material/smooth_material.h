// lib/material/smooth_material.h -- finds materials that reflect or transmit light only by mirrors and smooth glass.
#pragma once

#include <cstdint>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Index of the first material of the frame's surfaces whose S lobes are all mirrors or smooth glass; kNone if there
/// is none. Only the factors of a material count: textures that make parts of it smooth are ignored.
std::uint32_t first_smooth_material(const SceneFrame& frame);

}  // namespace tempolux
