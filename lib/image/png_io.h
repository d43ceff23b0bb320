// lib/image/png_io.h -- PNG to linear colour; png_io.cpp is the only user of libpng (save_png: preview.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lib/image/encoded_image.h"

#include "lib/image/image.h"

namespace tempolux {

/// Reads a PNG of any kind (grey, palette, 1 to 16 bits, interlaced) as linear R, G, B, premultiplied, with A
/// if it has transparency. Samples are sRGB, or a power law where a gAMA chunk says another exponent. The
/// text attribute "tempolux:source" says what was done. Size is checked against max_pixels and against the
/// file's bytes first. Throws InputError "FILE: ..." for what is not a PNG, damaged or truncated.
Image load_png(const std::string& path, std::uint64_t max_pixels);

/// Pixels of a PNG in memory as they are coded, palette expanded. Checks and errors as load_png.
CodedPixels decode_png(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels);

}  // namespace tempolux
