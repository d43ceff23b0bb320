// lib/image/nonzero_pixels.h -- masks of any kind: which pixels are meant.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// What a mask says: by pixel, 1 where any channel is not 0 (formats/mask/mask.md).
std::vector<std::uint8_t> nonzero_pixels(const Image& image);

}  // namespace tempolux
