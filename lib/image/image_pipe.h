// lib/image/image_pipe.h -- input and output of the program tempolux-oiio, the only one that links OpenImageIO.
//
// Standard input: an ImagePipeAsk, then the path of the file up to the end of the input. Standard output: an
// ImagePipeHead, then width x height x channels floats, row 0 on top, channels of a pixel together. On failure: one
// line on standard error and exit code 2. Little-endian, without padding.
#pragma once

#include <array>
#include <cstdint>

namespace tempolux {

struct ImagePipeAsk {
  std::array<char, 8> magic{'T', 'P', 'X', 'I', 'M', 'G', '1', '\n'};
  std::array<char, 8> format{};  ///< OpenImageIO's name: "jpeg" or "tiff"; other formats are refused
  std::uint64_t max_pixels = 0, max_channels = 0;
};

struct ImagePipeHead {
  std::array<char, 8> magic{'T', 'P', 'X', 'I', 'M', 'G', '1', '\n'};
  std::int32_t width = 0, height = 0, channels = 0;
  std::int32_t bits = 0;  ///< 8 or 16: values are code / largest code, encoded as in the file; 32: float samples
};

static_assert(sizeof(ImagePipeAsk) == 32 && sizeof(ImagePipeHead) == 24);

}  // namespace tempolux
