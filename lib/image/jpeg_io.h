// lib/image/jpeg_io.h -- decodes JPEG; jpeg_io.cpp is the only user of libjpeg.
#pragma once

#include <span>
#include <string>

#include "lib/image/encoded_image.h"

namespace tempolux {

/// Grey or RGB pixels of a JPEG file in memory, 8 bits, with YCbCr converted. Throws InputError "PLACE: JPEG: ..." for
/// a damaged or truncated file, more than max_pixels, more than 100 scans, or four channels.
CodedPixels decode_jpeg(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels);

}  // namespace tempolux
