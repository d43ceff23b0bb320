// lib/image/hdr_io.h -- reads Radiance pictures (.hdr, .pic) as linear colour.
#pragma once

#include <cstdint>
#include <string>

#include "lib/image/image.h"

namespace tempolux {

/// Reads a Radiance picture as linear R, G, B. The file has FORMAT 32-bit_rle_rgbe, lines from the top left (-Y H +X
/// W), and is uncompressed or run-length encoded, in the old or the new form. A pixel of bytes (r, g, b, e) is (r, g,
/// b) 2^(e - 136), zero if e is 0, divided by the product of the header's EXPOSURE lines (Ward, "Real Pixels", Graphics
/// Gems II, 1991; the reference manual's page on the picture format). Never NaN, infinite or negative.
///
/// Sizes are checked against max_pixels and the file's bytes before memory is allocated for them. Throws InputError
/// "FILE: byte N: WHAT; REMEDY" for XYZE colours, another order of pixels, and damaged or truncated files.
Image load_hdr(const std::string& path, std::uint64_t max_pixels);

}  // namespace tempolux
