#include <algorithm>
#include <span>

#include "formats/hash.h"
#include "lib/image/exr_io.h"

namespace tempolux {

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

}  // namespace tempolux
