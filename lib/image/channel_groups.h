// lib/image/channel_groups.h -- the groups of channels that --channels names (formats/frames/frames.md).
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "lib/image/image.h"

namespace tempolux {

/// The layers of a frame, in the order in which they are added to R, G and B (formats/frames/frames.md 2).
inline constexpr std::array<const char*, 6> kFrameLayers{"emission", "specular", "direct",
                                                         "caustic",  "indirect", "volume"};

/// True if the channel belongs to the group. RGBA: R, G, B, A. layers: the colours of emission, specular, direct,
/// caustic, indirect and volume. motion: forward.*, backward.*, valid, speed. cryptomatte: is_matte(). Any other group:
/// the channel of this name, and GROUP.*, as id.object of `id`.
bool is_in_group(std::string_view channel, std::string_view group);

/// True for channels of a layer, or of a view's layer, whose name begins with Crypto or crypto: CryptoObject00.R,
/// ViewLayer.CryptoAsset01.A. Such channels hold hashes of names and shares of the pixel (cryptomatte.h).
bool is_matte(std::string_view channel);

/// True for R, G, B and A of the picture or of a layer, but not of mattes.
inline bool is_colour(std::string_view channel) {
  const std::string_view last = channel.substr(channel.rfind('.') + 1);  // npos + 1 is 0
  return (last == "R" || last == "G" || last == "B" || last == "A") && !is_matte(channel);
}

/// True if the requested groups include this one.
inline bool asked(const std::vector<std::string>& groups, std::string_view group) {
  return std::ranges::find(groups, group) != groups.end();
}

/// Removes the channels that are in none of these groups. Throws InputError for a group of which the image has no
/// channel.
void keep_channels(const std::vector<std::string>& groups, Image& image);

}  // namespace tempolux
