// tests/support/layers.h -- sums over the layers of a path's light.
#pragma once

#include "lib/render/path_tracer.h"

namespace tempolux::test {

/// Radiance of all layers together, in one channel (green).
inline double total(const Layers& layers, int channel = 1) {
  double sum = 0;
  for (const Rgb& value : layers.value) sum += double(value[channel]);
  return sum;
}

}  // namespace tempolux::test
