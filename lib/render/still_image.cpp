// lib/render/still_image.cpp -- adds the change of kept pixels to an image.
#include <algorithm>

#include "lib/core/parallel_each.h"
#include "lib/render/layer_channels.h"
#include "lib/render/still_pixels.h"

namespace tempolux {
namespace {

/// Adds the noise and variance of the change to the channels that hold those of the kept pixels.
void add_noise_of_change(const StillPixels& still, Image& image) {
  for (const Channel& channel : still.noise_channels.channels) {
    Channel* const to = channel.name == "halves.confirmed" ? nullptr : image.find(channel.name);
    if (!to) continue;
    parallel_each(still.anew.size(), 4096, [&](std::size_t p) {
      if (!still.anew[p]) to->values[p] += channel.values[p];
    });
  }
}

}  // namespace

void add_change(const StillPixels& still, Image& image) {
  const auto layers = layer_channels(image);
  const auto sum = channels_of(image, "");
  float* const alpha = values_of(image, "A");
  bool all = true;
  for (std::size_t l = 0; l < kLayerCount; ++l)
    all &= l == std::size_t(Layer::volume) || (layers[l][0] && layers[l][1] && layers[l][2]);
  parallel_each(still.anew.size(), 4096, [&](std::size_t p) {
    if (still.anew[p]) return;
    const Layers& change = still.change.pixels[p];
    for (std::size_t c = 0; c < 3; ++c) {
      float shown = 0;
      for (std::size_t l = 0; l < kLayerCount; ++l) {
        const float by = change.value[l][int(c)];
        if (float* const to = layers[l][c]) to[p] = std::max(0.0f, to[p] + by), shown += to[p];
        if (!all && sum[c]) sum[c][p] += by;
      }
      if (sum[c]) sum[c][p] = all ? shown : std::max(0.0f, sum[c][p]);
    }
    if (alpha) alpha[p] = std::clamp(alpha[p] + change.coverage, 0.0f, 1.0f);
  });
  add_noise_of_change(still, image);
}

}  // namespace tempolux
