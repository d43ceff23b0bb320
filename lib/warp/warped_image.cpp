#include "lib/warp/warped_image.h"

#include <algorithm>

namespace tempolux {
namespace {

void add_channels(const WarpedFrame& warped, const std::vector<float>& colour, Image& image) {
  for (std::size_t c = 0; c < warped.names.size(); ++c) {
    std::vector<float>& values = image.add(warped.names[c]).values;
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = colour[p * warped.stride + c];
  }
}

}  // namespace

void add_colour(const WarpedFrame& warped, Image& image) { add_channels(warped, warped.colour, image); }

void add_candidate(const WarpedFrame& warped, std::size_t key, Image& image) {
  add_channels(warped, warped.candidates[key], image);
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
  return channel == "Z" || channel == "id.object" || channel.ends_with("epth.Z");
}

}  // namespace tempolux
