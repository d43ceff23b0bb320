// lib/material/smooth_material.h -- finds materials that reflect or transmit light only by mirrors and smooth glass, or
// by lobes so sharp that paths hardly ever meet a lamp without extent through them.
#pragma once

#include <cstdint>
#include <functional>

#include "lib/scene/at_frame.h"

namespace tempolux {

/// Index of the first material in use whose S lobes are all mirrors, smooth glass or sharper than roughness .07; kNone
/// if there is none. Textures are ignored, so a material that they make smooth in parts may be missed. panes: false
/// leaves out smooth thin walls. Light goes straight through them, so paths find what they let through, but not what
/// they reflect.
/// `plates`: surfaces that are left out as well, by number; light goes straight through them, too. Empty: none.
std::uint32_t first_smooth_material(const SceneFrame& frame, bool panes = true,
                                    const std::function<bool(std::uint32_t)>& plates = {});

}  // namespace tempolux
