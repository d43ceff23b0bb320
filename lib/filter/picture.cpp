#include "lib/filter/picture.h"

#include <algorithm>
#include <cmath>

namespace tempolux {

std::string channel_name(const std::string& layer, std::size_t c) {
  return layer.empty() ? kComponents[c] : layer + "." + kComponents[c];
}

bool holds(const Image& image, const std::string& name) {
  const Channel* channel = image.find(name);
  return channel && !channel->values.empty();
}

bool has_colour(const Image& image, const std::string& layer) {
  return holds(image, channel_name(layer, 0)) && holds(image, channel_name(layer, 1)) &&
         holds(image, channel_name(layer, 2));
}

Channel* float_channel(Image& image, const std::string& name) {
  Channel* channel = image.find(name);
  return channel && !channel->values.empty() ? channel : nullptr;
}

std::vector<std::size_t> confirmed_in(const Image& image, const std::string& layer) {
  std::vector<std::size_t> pixels;
  if (!holds(image, "halves.confirmed")) return pixels;
  const auto bit = std::find(kFrameLayers.begin(), kFrameLayers.end(), layer) - kFrameLayers.begin();
  const std::vector<float>& layers = image.find("halves.confirmed")->values;
  for (std::size_t p = 0; p < layers.size(); ++p)
    if (layers[p] >= 1 && layers[p] < 64 && (int(layers[p]) >> bit & 1)) pixels.push_back(p);
  return pixels;
}

void leave_numbers(Image& image) {
  for (Channel& channel : image.channels) {
    const bool depth = channel.name == "Z";
    for (float& value : channel.values)
      if (!std::isfinite(value)) value = depth ? INFINITY : 0.0f;
  }
}

LayerSums sum_layers(Image& image) {
  LayerSums sums;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t l = 0; l < kFrameLayers.size(); ++l) {
      const Channel* layer = float_channel(image, channel_name(kFrameLayers[l], c));
      if (!layer) continue;
      if (sums[c].empty()) sums[c] = layer->values;
      else
        std::transform(layer->values.begin(), layer->values.end(), sums[c].begin(), sums[c].begin(),
                       [](float v, float sum) { return sum + v; });
    }
  return sums;
}

void renew_picture(const LayerSums& before, const LayerSums& after, Image& image) {
  for (std::size_t c = 0; c < 3; ++c) {
    Channel* whole = float_channel(image, kComponents[c]);
    if (!whole || after[c].empty()) continue;
    for (std::size_t p = 0; p < whole->values.size(); ++p) {
      const float held = whole->values[p], rest = held - before[c][p];
      const bool more = std::isfinite(rest) && std::abs(rest) > 1e-3f * (std::abs(held) + std::abs(before[c][p]));
      whole->values[p] = more ? after[c][p] + rest : after[c][p];
    }
  }
}

}  // namespace tempolux
