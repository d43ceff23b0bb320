// lib/material/smooth_material.h -- which surfaces mirror or let through without spreading.
#pragma once

#include <cstdint>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// The first material of the frame's surfaces that reflects or lets through by mirrors and smooth glass alone; kNone:
/// none. Its factors decide: a texture that makes parts of it smooth is not looked at.
std::uint32_t first_smooth_material(const SceneFrame& frame);

}  // namespace tempolux
