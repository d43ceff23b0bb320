// lib/warp/warped_image.h -- warped colour as channels of a frame.
#pragma once

#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/warp/key_frame.h"
#include "lib/warp/warp.h"

namespace tempolux {

/// Moves the composed colour channels to an image of the frame's size.
void add_colour(WarpedFrame& warped, Image& image);

/// Moves what one key alone gives (WarpedFrame::candidates).
void add_candidate(WarpedFrame& warped, std::size_t key, Image& image);

/// Has the key LAYER.R?
bool has_layer(const KeyFrame& key, const std::string& layer);
/// Is it the name of a layer of colour (formats/frames/frames.md 2)?
bool has_layer_name(const std::string& group);
/// Is it a channel of data that a frame may have: Z, N, P, id.object, albedo?
bool is_data_channel(const std::string& channel);

}  // namespace tempolux
