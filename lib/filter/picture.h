// lib/filter/picture.h -- a frame's layers by name, and the picture as their sum.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

inline constexpr std::array<const char*, 3> kComponents{"R", "G", "B"};

/// "direct.R", or "R" of no layer. c: 0, 1, 2.
std::string channel_name(const std::string& layer, std::size_t c);
/// Is the channel there, with samples?
bool holds(const Image& image, const std::string& name);
/// nullptr if there is none, or it has no samples.
Channel* float_channel(Image& image, const std::string& name);

/// Sums of the layers by pixel, for R, G and B, in the order of frames.md 2; empty without any.
using LayerSums = std::array<std::vector<float>, 3>;
LayerSums sum_layers(Image& image);

/// The picture after its layers have changed: their sum. Where it held more light than its layers, as some of them are
/// not there, it keeps that. Half floats are off by 2^-11 each: twice that is no light.
void renew_picture(const LayerSums& before, const LayerSums& after, Image& image);

/// What is not finite in what passes the filter becomes 0; of depth infinity is allowed, and what is not a number
/// becomes it.
void leave_numbers(Image& image);

}  // namespace tempolux
