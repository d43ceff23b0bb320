// lib/image/images_module.h -- the interface between lib/image and the module tempolux-images; plain C types only.
#pragma once

#include <cstdint>

namespace tempolux {

inline constexpr std::uint32_t kPixelsAbi = 3;

/// The argument of a call: the image to read, and callbacks for its pixels and for errors.
struct PixelsRequest {
  std::uint32_t abi;           ///< kPixelsAbi; a module of another version refuses the call
  const char* path;            ///< a file to be read as load_image does, as linear R, G, B; null: `bytes`
  const unsigned char* bytes;  ///< a PNG or JPEG in memory, decoded to codes as decode_image does
  std::uint64_t size;          ///< of bytes
  const char* place;           ///< source of the bytes, for messages
  std::uint64_t max_pixels;
  /// Called once, when the size is known: returns memory for width*height*channels samples, row 0 on top, channels of a
  /// pixel together. bits is 8 or 16 for codes, 32 for floats. Null: no memory.
  void* (*allocate)(void* user, std::int32_t width, std::int32_t height, std::int32_t channels, std::int32_t bits);
  void (*say)(void* user, const char* message);  ///< reports the error
  void* user;                                    ///< first argument of both callbacks
};

enum PixelsResult : std::int32_t {
  pixels_ok = 0,
  pixels_bad_input = 1,    ///< the input is invalid
  pixels_no_resource = 2,  ///< no memory, or another failure that `say` reported
};

/// The module's only symbol. Throws nothing; thread-safe.
using PixelsEntry = std::int32_t(PixelsRequest*);
inline constexpr const char* kPixelsSymbol = "tempolux_read_pixels";

}  // namespace tempolux
