// lib/filter/picture.h -- a frame's layers by name, and R G B as their sum.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::array<const char*, 3> kComponents{"R", "G", "B"};
/// The layers of a frame, in the order of the bits of the channel halves.confirmed (formats/frames/frames.md).
inline constexpr std::array<const char*, 6> kLayersInOrder{"emission", "specular", "direct",
                                                           "caustic",  "indirect", "volume"};

/// "direct.R", or "R" if `layer` is empty. c: 0, 1, 2.
std::string channel_name(const std::string& layer, std::size_t c);
/// True if the channel exists and has samples.
bool holds(const Image& image, const std::string& name);
/// nullptr if the channel does not exist or has no samples.
Channel* float_channel(Image& image, const std::string& name);

/// The pixels for which the channel halves.confirmed names a layer; none without that channel.
std::vector<std::size_t> confirmed_in(const Image& image, const std::string& layer);

/// Sums of the layers by pixel, for R, G and B, in the order of frames.md 2; empty if there are no layers.
using LayerSums = std::array<std::vector<float>, 3>;
LayerSums sum_layers(Image& image);

/// Updates R G B after the layers have changed. Light that R G B held besides its layers stays. Half floats are off by
/// 2^-11 each, so a difference of up to twice that counts as no light.
void renew_picture(const LayerSums& before, const LayerSums& after, Image& image);

/// Replaces values that are not finite by 0 in channels that pass the filter. Depth may be infinite; a NaN depth
/// becomes infinite.
void leave_numbers(Image& image);

}  // namespace tempolux
