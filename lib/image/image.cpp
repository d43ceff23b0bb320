#include "lib/image/image.h"

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "formats/error.h"
#include "formats/hash.h"
#include "lib/image/channel_groups.h"

namespace tempolux {

std::vector<std::uint8_t> nonzero_pixels(const Image& image) {
  std::vector<std::uint8_t> mask(image.pixel_count());
  for (const Channel& channel : image.channels)
    for (std::size_t p = 0; p < mask.size(); ++p)
      mask[p] |= channel.ids.empty() ? channel.values[p] != 0 : channel.ids[p] != 0;
  return mask;
}

std::string digest_of(const Image& image) {
  std::vector<const Channel*> sorted;
  for (const Channel& channel : image.channels) sorted.push_back(&channel);
  std::ranges::sort(sorted, {}, &Channel::name);
  Hasher hasher;
  hasher.add(std::uint32_t(image.width));
  hasher.add(std::uint32_t(image.height));
  hasher.add(std::uint32_t(sorted.size()));
  for (const Channel* channel : sorted) {
    hasher.add(channel->name);
    hasher.add(std::uint32_t(channel->ids.empty() ? 0 : 1));
    if (channel->ids.empty()) hasher.add_array(std::span<const float>(channel->values));
    else hasher.add_array(std::span<const std::uint32_t>(channel->ids));
  }
  return hasher.hex();
}

std::string layer_channel(const std::string& layer, const char* component) {
  return layer.empty() ? component : layer + "." + component;
}

std::string pixel_name(std::size_t pixel, int width) {
  const auto w = std::size_t(width);
  return "pixel (" + std::to_string(pixel % w) + ", " + std::to_string(pixel / w) + ")";
}

const Channel* Image::find(std::string_view name) const {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const Channel& channel) { return channel.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

Channel* Image::find(std::string_view name) { return const_cast<Channel*>(std::as_const(*this).find(name)); }

Channel& Image::add(std::string name) {
  channels.push_back({std::move(name), std::vector<float>(pixel_count()), {}});
  return channels.back();
}

Channel& Image::add_ids(std::string name) {
  channels.push_back({std::move(name), {}, std::vector<std::uint32_t>(pixel_count())});
  return channels.back();
}

std::array<const std::vector<float>*, 3> Image::rgb(const std::string& layer) const {
  std::array<const std::vector<float>*, 3> planes{};
  constexpr std::array components{"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const Channel* channel = find(layer_channel(layer, components[c]));
    if (!channel || !channel->ids.empty()) {
      std::string known;
      for (const std::string& name : layers()) known += (known.empty() ? "" : ", ") + (name.empty() ? "RGB" : name);
      throw InputError("no colour layer \"" + (layer.empty() ? "RGB" : layer) + "\"; the image has " +
                       (known.empty() ? "none" : known));
    }
    planes[c] = &channel->values;
  }
  return planes;
}

std::vector<std::string> Image::layers() const {
  std::set<std::string> names;  // "" sorts first
  for (const Channel& channel : channels) {
    if (channel.name == "R") names.insert("");
    if (channel.name.size() > 2 && channel.name.ends_with(".R") && !is_matte(channel.name))
      names.insert(channel.name.substr(0, channel.name.size() - 2));
  }
  std::erase_if(names, [&](const std::string& name) {
    return !find(layer_channel(name, "G")) || !find(layer_channel(name, "B"));
  });
  return {names.begin(), names.end()};
}

}  // namespace tempolux
