// lib/image/exr_io.h -- frames to and from OpenEXR; the only user of OpenEXR.
#pragma once

#include <string>

#include "lib/image/image.h"

namespace tempolux {

struct ExrWriteOptions {
  bool half = false;       ///< colour channels (and layers) as float16: InputError for |value| > 65504. Z, N, P,
                           ///< motion and ids keep 32 bits.
  enum class Compression { none, zip } compression = Compression::zip;
};

/// Writes one scan-line EXR, single part. The file is created at exactly this path and not synced or
/// renamed: callers use an output that does (tools/output.h). No time stamp, no host name: equal images give equal files.
/// Throws ResourceError if it cannot be written; InputError for NaN or infinity in a colour channel, naming
/// channel and pixel (Z may be +infinity).
void save_exr(const std::string& path, const Image& image, const ExrWriteOptions& options = {});

struct ExrReadOptions {
  std::uint64_t max_pixels = 512ull << 20;
  bool allow_nan = false;
};

/// Reads a scan-line or tiled single-part EXR (of a multi-part file: the first part), all channels, half and float as float, uint as
/// ids. The data window must equal the display window or is placed into it, rest zero. Size is checked against the file's
/// bytes before anything is allocated; incomplete files, deep parts and NaN (unless allowed) are InputError "FILE: ...".
Image load_exr(const std::string& path, const ExrReadOptions& options = {});

/// 32 hexadecimal digits over size, channel names and samples; attributes and compression do not count.
std::string digest_of(const Image& image);

}  // namespace tempolux
