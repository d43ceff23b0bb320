#include "lib/warp/warped_image.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lib/image/channel_groups.h"

namespace tempolux {
namespace {

void add_channels(const std::vector<std::string>& names, std::vector<std::vector<float>>&& colour, Image& image) {
  for (std::size_t c = 0; c < names.size(); ++c) image.channels.push_back({names[c], std::move(colour[c]), {}});
}

}  // namespace

void add_colour(WarpedFrame& warped, Image& image) { add_channels(warped.names, std::move(warped.colour), image); }

void add_candidate(WarpedFrame& warped, std::size_t key, Image& image) {
  add_channels(warped.names, std::move(warped.candidates[key]), image);
}

bool has_layer(const KeyFrame& key, const std::string& layer) {
  return std::ranges::count(key.colour_names(), layer + ".R") > 0;
}

bool is_data_channel(const std::string& channel) {
  return std::ranges::any_of(std::array{"Z", "N", "P", "id", "albedo"},
                             [&](const char* group) { return is_in_group(channel, group); });
}

}  // namespace tempolux
