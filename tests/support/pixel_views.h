// tests/support/pixel_views.h -- describes what a picture shows by a function of raster position.
#pragma once

#include "lib/gather/place_records.h"

namespace tempolux::test {

/// A picture from the function seen(x, y, random), which returns what is visible at the raster position (x, y), an
/// optional SeenPoint. `random` draws the path to the visible place; null: the most probable path.
template <class Seen>
PixelView pixel_by_pixel(Seen seen) {
  return [seen](const Look& look) { return seen(look.x, look.y, look.random ? &*look.random : nullptr); };
}

}  // namespace tempolux::test
