// lib/image/module.h -- what lib/image and the module tempolux-oiio.so agree on; plain C types only.
#pragma once

#include <cstdint>

namespace tempolux {

inline constexpr std::uint32_t kImageModuleAbi = 1;

/// One call: the file to read, where its pixels go, what went wrong.
struct ImageModuleRequest {
  std::uint32_t abi;  ///< kImageModuleAbi; another: refused
  const char* path;
  const char* format;  ///< OpenImageIO's name: "jpeg" or "tiff"; nothing else is opened
  std::uint64_t max_pixels;
  std::uint32_t max_channels;
  /// Called once, when the size is known and allowed: width*height*channels floats, row 0 on top, channels of
  /// a pixel together. bits: 8 or 16 for integer samples (values code / largest code, still encoded as in the
  /// file), 32 for float samples. Null: no memory.
  float* (*allocate)(void* user, std::int32_t width, std::int32_t height, std::int32_t channels,
                     std::int32_t bits);
  void* user;
  char message[1024];  ///< of an error, ends in 0
};

enum ImageModuleResult : std::int32_t {
  image_module_ok = 0,
  image_module_bad_input = 1,
  image_module_no_memory = 2
};

/// The module's only symbol.
using ImageModuleEntry = std::int32_t(ImageModuleRequest*);
inline constexpr const char* kImageModuleSymbol = "tempolux_image_module";

}  // namespace tempolux
