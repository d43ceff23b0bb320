// lib/image/nonzero_pixels.h -- reads masks of any kind.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// For each pixel, 1 if any channel of the image is not 0, else 0 (formats/mask/mask.md).
std::vector<std::uint8_t> nonzero_pixels(const Image& image);

}  // namespace tempolux
