// lib/image/png_io.h -- reads PNG as linear colour; png_io.cpp is the only user of libpng (save_png: preview.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lib/image/encoded_image.h"

#include "lib/image/image.h"

namespace tempolux {

/// Reads a PNG of any kind (grey, palette, 1 to 16 bits, interlaced) as linear R, G, B; if it has transparency, they
/// are multiplied by alpha, and A is added. Samples are sRGB, or a power law if a gAMA chunk gives another exponent;
/// the text attribute "tempolux:source" says which. The size is checked against max_pixels and the file's bytes before
/// memory is allocated. Throws InputError "FILE: ..." for other formats, damaged and truncated files.
Image load_png(const std::string& path, std::uint64_t max_pixels);

/// The codes of a PNG in memory, with the palette expanded. Checks and errors as load_png().
CodedPixels decode_png(std::span<const unsigned char> bytes, const std::string& place, std::uint64_t max_pixels);

}  // namespace tempolux
