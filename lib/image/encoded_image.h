// lib/image/encoded_image.h -- PNG, JPEG and WebP files in memory: their size without decoding, and their pixels.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

/// A PNG, JPEG or WebP file in memory, not decoded.
struct EncodedImage {
  std::string place;  ///< where it comes from, for messages
  std::vector<unsigned char> bytes;
  int width = 0, height = 0;  ///< px, from its header
  std::string digest;         ///< of the bytes
};

struct ImageHeader {
  enum class Format { png, jpeg, webp };
  Format format = Format::png;
  int width = 0, height = 0;  ///< px, at least 1
  bool has_alpha = false;     ///< of a WebP
};

/// Format and size of a PNG, JPEG or WebP file from its first bytes; nothing is decoded, nothing allocated. Throws
/// InputError "PLACE: ..." for other formats (naming those we know) and for a damaged header.
ImageHeader read_image_header(std::span<const unsigned char> bytes, const std::string& place);

/// Pixels as they are in a file, still encoded; row 0 on top, channels of a pixel together.
struct CodedPixels {
  int width = 0, height = 0;
  int channels = 0;  ///< 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha (not premultiplied)
  int bits = 8;      ///< 8 or 16; 16 in the machine's order
  std::vector<std::uint8_t> bytes;
};

/// Decodes an image. What the file says about its colour space (gAMA, iCCP, ...) is not looked at: glTF 2.0, 3.8.2,
/// leaves that to the texture. WebP is decoded by a helper process (lib/core/unpack.h). Throws InputError "PLACE: ..."
/// for a damaged or truncated file, one whose size is not what the header said or over max_pixels, and for JPEG in
/// CMYK.
CodedPixels decode_image(const EncodedImage& image, std::uint64_t max_pixels);

}  // namespace tempolux
