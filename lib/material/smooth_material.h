// lib/material/smooth_material.h -- finds materials that mirror or transmit light without spreading it.
#pragma once

#include <cstdint>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// The first material of the frame's surfaces that scatters by mirrors and smooth glass alone; kNone if there is none.
/// Only its factors count: textures that make parts of it smooth are ignored.
std::uint32_t first_smooth_material(const SceneFrame& frame);

}  // namespace tempolux
