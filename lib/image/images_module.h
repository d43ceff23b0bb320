// lib/image/images_module.h -- what lib/image and the module tempolux-images agree on; plain C types only.
#pragma once

#include <cstdint>

namespace tempolux {

inline constexpr std::uint32_t kPixelsAbi = 2;

/// One call: the image to read, where its pixels go, what went wrong.
struct PixelsRequest {
  std::uint32_t abi;           ///< kPixelsAbi; another: refused
  const char* path;            ///< a file, read as load_image does: linear R, G, B; null: `bytes`
  std::int32_t mask;           ///< 1: of the file nonzero_pixels(), one channel of 8 bits
  const unsigned char* bytes;  ///< a PNG or JPEG in memory, decoded as decode_image does: its codes
  std::uint64_t size;          ///< of bytes
  const char* place;           ///< where the bytes come from, for messages
  std::uint64_t max_pixels;
  /// Called once, when the pixels are known: width*height*channels samples, row 0 on top, channels of a pixel together;
  /// bits 8 or 16: codes in as many bits; 32: floats. Null: no memory.
  void* (*allocate)(void* user, std::int32_t width, std::int32_t height, std::int32_t channels, std::int32_t bits);
  void (*say)(void* user, const char* message);  ///< what went wrong
  void* user;                                    ///< of both
};

enum PixelsResult : std::int32_t {
  pixels_ok = 0,
  pixels_bad_input = 1,    ///< the image is at fault
  pixels_no_resource = 2,  ///< the machine is: no memory, or what was said
};

/// The module's only symbol. Throws nothing; thread-safe.
using PixelsEntry = std::int32_t(PixelsRequest*);
inline constexpr const char* kPixelsSymbol = "tempolux_read_pixels";

}  // namespace tempolux
