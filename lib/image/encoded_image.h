// lib/image/encoded_image.h -- PNG and JPEG files in memory: their size without decoding, and their pixels.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

struct ImageHeader {
  enum class Format { png, jpeg };
  Format format = Format::png;
  int width = 0, height = 0;  ///< px, at least 1
};

/// Format and size of a PNG or JPEG file from its first bytes; nothing is decoded, nothing allocated. Throws InputError
/// "PLACE: ..." for other formats (naming those we know and what converts them) and for a damaged header.
ImageHeader read_image_header(std::span<const unsigned char> bytes, const std::string& place);

}  // namespace tempolux
