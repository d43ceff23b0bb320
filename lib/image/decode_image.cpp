// Apart from encoded_image.cpp: who reads headers does not link the decoders.
#include "formats/error.h"
#include "lib/image/encoded_image.h"
#include "lib/image/jpeg_io.h"
#include "lib/image/png_io.h"

namespace tempolux {

CodedPixels decode_image(const EncodedImage& image, std::uint64_t max_pixels) {
  const ImageHeader header = read_image_header(image.bytes, image.place);
  CodedPixels pixels = header.format == ImageHeader::Format::png ? decode_png(image.bytes, image.place, max_pixels)
                                                                 : decode_jpeg(image.bytes, image.place, max_pixels);
  if (pixels.width != header.width || pixels.height != header.height)
    throw InputError(image.place + ": is not of the size its header says; it is damaged");
  return pixels;
}

}  // namespace tempolux
