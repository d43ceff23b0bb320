// lib/aqm/display_speed.h -- how fast what a pixel shows moves across the display.
#pragma once

#include <vector>

#include "lib/image/pixel_flow.h"

namespace tempolux::vision {

/// Degrees per second on a display of `pixels_per_degree` at `frames_per_second`, from the forward flow, or
/// the backward one where only that is known. Pixels of unknown motion take the fastest of the nearest pixels
/// that are known (8 neighbours, ring by ring): what appears and disappears there is no easier to see than
/// what moves past it. 0 everywhere if nothing is known.
std::vector<float> display_speed(const PixelFlow& flow, double pixels_per_degree, double frames_per_second);

}  // namespace tempolux::vision
