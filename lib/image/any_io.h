// lib/image/any_io.h -- images of any format we read: EXR, PNG and Radiance HDR here, others by a helper
// program.
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

/// Reads an image as linear Rec. 709 R, G, B (and whatever else an EXR has). The first bytes decide the
/// format, not the name: OpenEXR, PNG and Radiance HDR are read here, JPEG and TIFF by the program
/// tempolux-oiio in a process of its own, which has limits of memory and time and can open nothing else; everything
/// else is refused. Samples of 8 or 16 bits are sRGB and become linear, float samples are linear already;
/// "tempolux:source" says which. One channel is grey.
///
/// Throws InputError "FILE: ...": unreadable, unknown or damaged, too large, NaN or infinite (as load_exr),
/// of a format whose helper was not built or not installed, or of one on which the helper dies; ResourceError without
/// memory.
Image load_image(const std::string& path, const ImageReadOptions& options = {});

}  // namespace tempolux
