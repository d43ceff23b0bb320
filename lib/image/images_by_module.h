// lib/image/images_by_module.h -- images for programs that seldom need one. The libraries that read them (OpenEXR,
// libpng, libjpeg) are linked by the module tempolux-images.so, which is loaded for the first image. Linking them
// directly took a fifth of scene-plan's time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/encoded_image.h"

namespace tempolux {

/// decode_image() of encoded_image.h by the module. Also throws InputError if the module is missing, std::bad_alloc
/// without memory.
CodedPixels decode_by_module(const EncodedImage& image, std::uint64_t max_pixels);

/// Linear Rec. 709 colours, row 0 on top.
struct LinearPixels {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
};

/// R, G and B of load_image() of any_io.h by the module. Also throws InputError if a channel or the module is missing,
/// std::bad_alloc without memory.
LinearPixels load_by_module(const std::string& path, std::uint64_t max_pixels);

}  // namespace tempolux
