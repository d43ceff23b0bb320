// lib/image/any_io.h -- reads images of any format: EXR, PNG and Radiance HDR directly, others by a child process.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/module_folders.h"
#include "lib/image/image.h"

namespace tempolux {

struct ImageReadOptions {
  std::uint64_t max_pixels = 512ull << 20;
  std::vector<std::string> module_folders = default_module_folders();
};

/// Reads an image as linear Rec. 709 R, G, B; an EXR keeps all its channels. The format follows from the first bytes,
/// not from the name. OpenEXR, PNG and Radiance HDR are read in this process; JPEG and TIFF by the program
/// tempolux-oiio in a child process, which has limits of memory and time and can open nothing else; all other formats
/// are refused. Samples of 8 or 16 bits are decoded as sRGB; float samples are linear already; "tempolux:source" says
/// which. A single channel is grey.
///
/// Throws InputError "FILE: ...": unreadable, unknown or damaged, too large, NaN or infinite (as load_exr), a format
/// whose program was not built or installed, or a file on which the child process dies; ResourceError without memory.
Image load_image(const std::string& path, const ImageReadOptions& options = {});

}  // namespace tempolux
