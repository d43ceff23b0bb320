// lib/image/any_io.h -- images of any format we read: EXR, PNG and Radiance HDR here, others through a module
// opened at need.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/image.h"
#include "lib/image/open_module.h"

namespace tempolux {

struct ImageReadOptions {
  std::uint64_t max_pixels = 512ull << 20;
  std::vector<std::string> module_folders = default_module_folders();
};

/// Reads an image as linear Rec. 709 R, G, B (and whatever else an EXR has). The first bytes decide the
/// format, not the name: OpenEXR, PNG and Radiance HDR are read here, JPEG and TIFF by the module
/// tempolux-oiio.so, which is loaded the first time and stays; everything else is refused. Samples of 8 or 16
/// bits are sRGB and become linear, float samples are linear already; "tempolux:source" says which. One
/// channel is grey.
///
/// Throws InputError "FILE: ...": unreadable, unknown or damaged, too large, NaN or infinite (as load_exr),
/// or of a format whose module was not built or not installed; ResourceError without memory.
Image load_image(const std::string& path, const ImageReadOptions& options = {});

}  // namespace tempolux
