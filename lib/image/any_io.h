// lib/image/any_io.h -- reads images of any format: EXR, PNG and Radiance HDR directly, others by a child process.
#pragma once

#include <cstdint>
#include <string>

#include "lib/image/image.h"

namespace tempolux {

/// Reads an image as linear Rec. 709 R, G, B; an EXR keeps all its channels. The first bytes, not the name, decide the
/// format. OpenEXR, PNG and Radiance HDR are read in this process. JPEG and TIFF are read by the program tempolux-oiio
/// in a child process, which has limits of memory and time and can open nothing else. Other formats are refused.
/// Samples of 8 or 16 bits are decoded as sRGB; float samples are linear. Except for an EXR, the image's text
/// "tempolux:source" names the format, the bits and the decoding. An image with a single channel is grey: R, G and B
/// are equal.
///
/// Throws InputError "FILE: ..." if the file is unreadable, damaged, larger than max_pixels or of an unknown format, or
/// if a sample is NaN or infinite (as load_exr). Also throws InputError if tempolux-oiio is needed and is not
/// installed, or if the child process dies. Throws ResourceError if there is too little memory.
Image load_image(const std::string& path, std::uint64_t max_pixels = 512ull << 20);

}  // namespace tempolux
