// lib/image/channel_groups.h -- channels by the groups that --channels names (formats/frames/frames.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// Is the channel one of the group? RGBA: R G B A; layers: the colours of emission, specular, direct, caustic, indirect
/// and volume; id: id.object; motion: forward.*, backward.*, valid, speed; any other group: the channel of this name
/// and GROUP.*.
bool is_in_group(std::string_view channel, std::string_view group);

/// Leaves the channels of these groups alone. InputError for a group of which the image has none.
void keep_channels(const std::vector<std::string>& groups, Image& image);

}  // namespace tempolux
