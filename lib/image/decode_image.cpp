// lib/image/decode_image.cpp -- decodes images. Separate from encoded_image.cpp, so that readers of headers do not link
// the decoders.
#include "formats/error.h"
#include "lib/core/unpack.h"
#include "lib/image/encoded_image.h"
#include "lib/image/jpeg_io.h"
#include "lib/image/png_io.h"

namespace tempolux {
namespace {

/// Decodes in a child process.
CodedPixels decode_packed(Packer packer, int channels, const EncodedImage& image, const ImageHeader& header,
                          std::uint64_t max_pixels) {
  const std::uint64_t count = std::uint64_t(header.width) * std::uint64_t(header.height);
  if (count > max_pixels)
    throw InputError(image.place + ": " + std::to_string(header.width) + "x" + std::to_string(header.height) +
                     " pixels, over the limit of " + std::to_string(max_pixels));
  CodedPixels pixels;
  pixels.width = header.width;
  pixels.height = header.height;
  pixels.channels = channels;
  PackedPiece piece;
  piece.packer = packer;
  piece.settings = {std::uint32_t(pixels.width), std::uint32_t(pixels.height), std::uint32_t(pixels.channels)};
  piece.bytes = image.bytes;
  piece.unpacked_bytes = count * std::uint64_t(pixels.channels);
  piece.place = image.place;
  piece.remedy = "convert it to PNG or JPEG";
  pixels.bytes = unpack({piece});
  return pixels;
}

}  // namespace

CodedPixels decode_image(const EncodedImage& image, std::uint64_t max_pixels) {
  const ImageHeader header = read_image_header(image.bytes, image.place);
  if (header.format == ImageHeader::Format::webp)
    return decode_packed(Packer::webp, header.has_alpha ? 4 : 3, image, header, max_pixels);
  if (header.format == ImageHeader::Format::avif) return decode_packed(Packer::avif, 4, image, header, max_pixels);
  CodedPixels pixels = header.format == ImageHeader::Format::png ? decode_png(image.bytes, image.place, max_pixels)
                                                                 : decode_jpeg(image.bytes, image.place, max_pixels);
  if (pixels.width != header.width || pixels.height != header.height)
    throw InputError(image.place + ": is not of the size its header says; it is damaged");
  return pixels;
}

}  // namespace tempolux
