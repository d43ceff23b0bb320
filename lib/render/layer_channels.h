// lib/render/layer_channels.h -- the channels of an image that hold the radiance of layers.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "lib/image/image.h"
#include "lib/render/path_tracer.h"

namespace tempolux {

/// The values of the channel of this name; null if the image lacks the channel or if the channel holds ids. AnyImage:
/// Image or const Image.
template <class AnyImage>
auto values_of(AnyImage& image, const std::string& name) {
  auto* const channel = image.find(name);
  return channel && channel->ids.empty() ? channel->values.data() : nullptr;
}

/// The values of the channels PREFIX + R, G, B.
template <class AnyImage>
auto channels_of(AnyImage& image, const std::string& prefix) {
  return std::array{values_of(image, prefix + "R"), values_of(image, prefix + "G"), values_of(image, prefix + "B")};
}

/// The values of the channels LAYER.R, .G and .B of each layer.
template <class AnyImage>
auto layer_channels(AnyImage& image) {
  std::array<decltype(channels_of(image, "")), kLayerCount> layers{};
  for (std::size_t l = 0; l < kLayerCount; ++l) layers[l] = channels_of(image, std::string(kLayerNames[l]) + ".");
  return layers;
}

}  // namespace tempolux
