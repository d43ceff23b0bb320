// lib/image/encoded_image.h -- PNG, JPEG, WebP and AVIF files in memory: reads their size without decoding, and decodes
// them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tempolux {

struct SpecularGlossiness;  // specular_glossiness.h

/// A PNG, JPEG, WebP or AVIF file in memory, not decoded; or an image that is made from such files.
struct EncodedImage {
  std::string place;  ///< source of the bytes, for messages
  std::vector<unsigned char> bytes;
  int width = 0, height = 0;  ///< px, from its header
  std::string digest;         ///< of the bytes, or of what the image is made from
  /// Makes the image when it is decoded. nullptr: the bytes are the image.
  std::shared_ptr<const SpecularGlossiness> made_from{};
};

/// Format and size of an encoded image.
struct ImageHeader {
  enum class Format { png, jpeg, webp, avif };
  Format format = Format::png;
  int width = 0, height = 0;  ///< px, at least 1
  bool has_alpha = false;     ///< of a WebP
  bool four_inks = false;     ///< of a JPEG: CMYK or YCCK
};

/// Format and size of a PNG, JPEG, WebP or AVIF file from its first bytes, without decoding or allocating. Throws
/// InputError "PLACE: ..." for other formats (naming the known ones) and for a damaged header.
ImageHeader read_image_header(std::span<const unsigned char> bytes, const std::string& place);

/// The codes of an image's pixels as in the file; row 0 on top, channels of a pixel together.
struct CodedPixels {
  int width = 0, height = 0;
  int channels = 0;  ///< 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha (not premultiplied)
  int bits = 8;      ///< 8 or 16; 16-bit codes are in the machine's byte order
  std::vector<std::uint8_t> bytes;
};

/// Decodes an image. What the file says about its colour space (gAMA, iCCP, ...) is ignored: in glTF 2.0, 3.8.2, the
/// texture decides. A child process decodes WebP and AVIF (lib/core/unpack.h). Throws InputError "PLACE: ..." if the
/// file is damaged or truncated, or has more than max_pixels or another size than its header says.
CodedPixels decode_image(const EncodedImage& image, std::uint64_t max_pixels);

}  // namespace tempolux
