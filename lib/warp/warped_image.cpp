#include "lib/warp/warped_image.h"

#include <algorithm>
#include <utility>

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
  return std::find(key.colour_names().begin(), key.colour_names().end(), layer + ".R") != key.colour_names().end();
}

bool has_layer_name(const std::string& group) {
  for (const char* layer : {"emission", "specular", "direct", "caustic", "indirect", "volume"})
    if (group == layer) return true;
  return false;
}

bool is_data_channel(const std::string& channel) {
  for (const char* prefix : {"N.", "P.", "albedo."})
    if (channel.starts_with(prefix)) return true;
  return channel == "Z" || channel == "id.object";
}

}  // namespace tempolux
