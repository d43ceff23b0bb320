// lib/filter/picture.h -- a frame's layers by name, and R G B as their sum.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/image/channel_groups.h"
#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::array<const char*, 3> kComponents{"R", "G", "B"};
/// "direct.R", or "R" if `layer` is empty. c: 0, 1, 2.
std::string channel_name(const std::string& layer, std::size_t c);
/// nullptr if the channel does not exist or has no samples.
Channel* float_channel(Image& image, const std::string& name);
/// True if the channel exists and has samples.
bool holds(const Image& image, const std::string& name);
/// True if holds() is true for the R, G and B of a layer.
bool has_colour(const Image& image, const std::string& layer);

/// The pixels in which halves.confirmed has the bit of a layer; bits are in the order of kFrameLayers. None without
/// that channel.
std::vector<std::size_t> confirmed_in(const Image& image, const std::string& layer);

/// Sums of the layers by pixel, for R, G and B; empty if there are no layers.
using LayerSums = std::array<std::vector<float>, 3>;
LayerSums sum_layers(Image& image);

/// Updates R, G and B after the layers have changed. Light that R, G and B held besides the layers stays. A difference
/// between R, G, B and the layers' sum of up to 2^-10 counts as the rounding of half floats, which are off by 2^-11
/// each.
void renew_picture(const LayerSums& before, const LayerSums& after, Image& image);

/// Replaces values that are not finite: by infinity in Z, by 0 in all other channels.
void leave_numbers(Image& image);

}  // namespace tempolux
