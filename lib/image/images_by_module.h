// lib/image/images_by_module.h -- images for programs that seldom need one: what reads them (OpenEXR, libpng, libjpeg)
// is linked by the module tempolux-images.so and opened with the first image. Linked, it was a fifth of scene-plan's
// work.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/core/vec.h"
#include "lib/image/encoded_image.h"

namespace tempolux {

/// decode_image of encoded_image.h; InputError too if the module is not there, std::bad_alloc without memory.
CodedPixels decode_by_module(const EncodedImage& image, std::uint64_t max_pixels);

/// Linear colour, row 0 on top.
struct LinearPixels {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
};

/// R, G and B of load_image of any_io.h; InputError if it lacks one of them, or the module is not there, std::bad_alloc
/// without memory.
LinearPixels load_by_module(const std::string& path, std::uint64_t max_pixels);

/// A mask: nonzero_pixels() of an image.
struct MaskPixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};
/// InputError and std::bad_alloc as above.
MaskPixels mask_by_module(const std::string& path, std::uint64_t max_pixels);

}  // namespace tempolux
