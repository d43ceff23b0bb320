// lib/image/jpeg_io.h -- decodes JPEG; jpeg_io.cpp is the only user of libjpeg.
#pragma once

#include <span>
#include <string>

#include "lib/image/encoded_image.h"

namespace tempolux {

/// Grey or RGB pixels of a JPEG file in memory, 8 bits, with YCbCr converted. Four inks (CMYK, YCCK) become
/// (1 - ink) (1 - black), without their colour profile; Adobe's programs store 1 - ink. Throws InputError "PLACE: JPEG:
/// ..." for a damaged or truncated file, more than max_pixels, or more than 100 scans.
CodedPixels decode_jpeg(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels);

}  // namespace tempolux
