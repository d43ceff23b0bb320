// lib/aqm/display_speed.h -- the speed at which surfaces move across the display.
#pragma once

#include <vector>

#include "lib/image/pixel_flow.h"

namespace tempolux::vision {

/// Degrees per second on a display of `pixels_per_degree` at `frames_per_second`, from the forward flow, or from the
/// backward flow where only that is known. A pixel of unknown motion gets the largest speed of the nearest known pixels
/// (8 neighbours, ring by ring): an object that appears there is no easier to see than one that moves past. 0
/// everywhere if no motion is known.
std::vector<float> display_speed(const PixelFlow& flow, double pixels_per_degree, double frames_per_second);

}  // namespace tempolux::vision
