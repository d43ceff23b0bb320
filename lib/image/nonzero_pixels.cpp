#include "lib/image/nonzero_pixels.h"

namespace tempolux {

std::vector<std::uint8_t> nonzero_pixels(const Image& image) {
  std::vector<std::uint8_t> mask(image.pixel_count());
  for (const Channel& channel : image.channels)
    for (std::size_t p = 0; p < mask.size(); ++p)
      mask[p] |= channel.ids.empty() ? channel.values[p] != 0 : channel.ids[p] != 0;
  return mask;
}

}  // namespace tempolux
