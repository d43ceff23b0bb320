// lib/warp/warped_image.h -- stores warped colour as channels of a frame.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/warp/key_frame.h"
#include "lib/warp/warp.h"

namespace tempolux {

/// Moves the composed colour channels to an image of the frame's size.
void add_colour(WarpedFrame& warped, Image& image);

/// Moves the colours from one key alone (WarpedFrame::candidates) to an image of the frame's size.
void add_candidate(WarpedFrame& warped, std::size_t key, Image& image);

/// True if the key has the channel LAYER.R.
bool has_layer(const KeyFrame& key, const std::string& layer);
/// True if the channel holds surface data: Z, N, P, id.object, albedo.
bool is_data_channel(const std::string& channel);

}  // namespace tempolux
