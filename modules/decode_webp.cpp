// modules/decode_webp.cpp -- decodes WebP images with libwebp.
#include <webp/decode.h>

#include "modules/decode.h"

namespace tempolux {

std::string decode_webp(std::span<const std::uint32_t> settings, std::span<const unsigned char> packed,
                        std::span<unsigned char> unpacked) {
  constexpr std::uint64_t most = 16384;  // largest width and height of a WebP image: 14 bits
  ImageRequest request;
  if (std::string wrong = request.read("WebP", most, 3, settings, unpacked.size()); !wrong.empty()) return wrong;
  const auto [width, height, channels] = request;
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(packed.data(), packed.size(), &features) != VP8_STATUS_OK)
    return "finds no WebP image in it: it is damaged or cut short";
  if (features.has_animation != 0) return "finds an animated WebP: a texture must be one picture";
  if (std::uint64_t(features.width) != width || std::uint64_t(features.height) != height)
    return "finds an image of another size than its header says: it is damaged";
  const auto decode = channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  if (!decode(packed.data(), packed.size(), unpacked.data(), unpacked.size(), int(width * channels)))
    return "cannot decode it: it is damaged or cut short";
  return "";
}

}  // namespace tempolux
