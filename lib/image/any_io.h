// lib/image/any_io.h -- reads images of any format: EXR, PNG and Radiance HDR directly, others by a child process.
#pragma once

#include <cstdint>
#include <string>

#include "lib/image/image.h"

namespace tempolux {

/// Reads an image as linear Rec. 709 R, G, B; an EXR keeps all its channels. The first bytes, not the name, decide the
/// format. OpenEXR, PNG and Radiance HDR are read in this process. JPEG and TIFF are read by the program tempolux-oiio
/// in a child process, which has limits of memory and time and can open nothing else. Other formats are refused.
/// Samples of 8 or 16 bits are decoded as sRGB, float samples are linear; "tempolux:source" says which. A single
/// channel is grey.
///
/// Throws InputError "FILE: ..." if the file is unreadable, unknown, damaged, larger than max_pixels, or has NaN or
/// infinity (as load_exr); if the format's program was not built or installed, or the child process dies. Throws
/// ResourceError without memory.
Image load_image(const std::string& path, std::uint64_t max_pixels = 512ull << 20);

}  // namespace tempolux
