#include "lib/image/channel_groups.h"

#include <algorithm>

#include "formats/error.h"

namespace tempolux {

bool is_matte(std::string_view channel) {
  const std::size_t last = channel.rfind('.');
  if (last == std::string_view::npos) return false;
  std::string_view layer = channel.substr(0, last);
  layer.remove_prefix(layer.rfind('.') + 1);  // npos + 1 is 0
  return layer.starts_with("Crypto") || layer.starts_with("crypto");
}

bool is_in_group(std::string_view channel, std::string_view group) {
  const auto starts_with_group = [&](std::string_view name) {
    return channel.size() > name.size() && channel.starts_with(name) && channel[name.size()] == '.';
  };
  if (group == "RGBA") return channel == "R" || channel == "G" || channel == "B" || channel == "A";
  if (group == "layers") {
    return channel.size() > 2 && std::any_of(kFrameLayers.begin(), kFrameLayers.end(), [&](std::string_view layer) {
             return starts_with_group(layer) && channel.size() == layer.size() + 2;
           });
  }
  if (group == "motion")
    return starts_with_group("forward") || starts_with_group("backward") || channel == "valid" || channel == "speed";
  if (group == "cryptomatte") return is_matte(channel);
  return channel == group || starts_with_group(group);
}

void keep_channels(const std::vector<std::string>& groups, Image& image) {
  const auto kept = [&](const std::string& group) {
    return std::any_of(image.channels.begin(), image.channels.end(),
                       [&](const Channel& c) { return is_in_group(c.name, group); });
  };
  for (const std::string& group : groups)
    if (!kept(group)) {
      std::string list;
      for (const Channel& channel : image.channels) list += (list.empty() ? "" : ", ") + channel.name;
      throw InputError("no channels '" + group + "'; there are " + list);
    }
  std::erase_if(image.channels, [&](const Channel& channel) {
    return std::none_of(groups.begin(), groups.end(),
                        [&](const std::string& group) { return is_in_group(channel.name, group); });
  });
}

}  // namespace tempolux
