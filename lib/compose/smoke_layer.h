// lib/compose/smoke_layer.h -- puts smoke over the pixels of a frame.
#pragma once

#include <vector>

#include "lib/compose/compose.h"
#include "lib/image/image.h"

namespace tempolux {

/// True if the frame's layer volume is not black everywhere.
bool has_smoke(const Image& frame);

/// Adds the light of the smoke to the layer volume and to R, G, B, and multiplies all other light and 1 - A by the
/// smoke's transmittance. If the frame is attenuated by the smoke already (`attenuated`), only light is added.
void add_smoke(const std::vector<SmokePixel>& smoke, bool attenuated, Image& frame);

}  // namespace tempolux
