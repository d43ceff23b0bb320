// tests/support/pixel_views.h -- what a picture sees, told pixel by pixel.
#pragma once

#include "lib/gather/place_records.h"

namespace tempolux::test {

/// seen(x, y, random): what raster position (x, y) sees, an optional SeenPoint; random: null, or what the way is drawn
/// from.
template <class Seen>
PixelView pixel_by_pixel(Seen seen) {
  return [seen](const Look& look) { return seen(look.x, look.y, look.random ? &*look.random : nullptr); };
}

}  // namespace tempolux::test
