// tests/support/pixel_views.h -- what a picture sees, told pixel by pixel.
#pragma once

#include "lib/gather/place_records.h"

namespace tempolux::test {

/// seen(x, y, random): what raster position (x, y) sees, an optional SeenPoint; random: null, or what the way is drawn from.
template <class Seen>
PixelViews pixel_by_pixel(Seen seen) {
  return [seen](std::span<const Look> looks, std::span<std::optional<SeenPoint>> points) {
    for (std::size_t i = 0; i < looks.size(); ++i) points[i] = seen(looks[i].x, looks[i].y, looks[i].random ? &*looks[i].random : nullptr);
  };
}

}  // namespace tempolux::test
