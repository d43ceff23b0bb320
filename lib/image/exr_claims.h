// lib/image/exr_claims.h -- reads and checks the sizes that an EXR header claims, without OpenEXR.
//
// OpenEXR allocates offset tables, attributes and line buffers by the numbers in a header. So this reader parses the
// header first, in constant memory, and refuses claims that the file is too short to hold.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/image/byte_file.h"

namespace tempolux {

/// Pixels x0 .. x1, y0 .. y1, both included.
struct PixelWindow {
  std::int32_t x0 = 0, y0 = 0, x1 = -1, y1 = -1;
  bool operator==(const PixelWindow&) const = default;
  std::int64_t width() const { return std::int64_t(x1) - x0 + 1; }
  std::int64_t height() const { return std::int64_t(y1) - y0 + 1; }
};

/// What the header of an EXR says about the file's first part.
struct ExrClaims {
  struct ClaimedChannel {
    std::string name;
    std::int32_t type = 0;  ///< 0 uint, 1 half, 2 float
    std::int32_t x_sampling = 1, y_sampling = 1;
  };
  PixelWindow data, display;
  std::vector<ClaimedChannel> channels;
  std::int32_t compression = -1;                  ///< -1: the attribute is missing
  std::uint32_t tile_width = 0, tile_height = 0;  ///< 0: scan lines
  bool deep = false;
  bool multipart = false;
  std::uint64_t header_bytes = 0;        ///< position of the offset table, in a file of one part
  std::int32_t lines_per_chunk() const;  ///< in parts stored as scan lines
};

/// Claims of the first part. Throws InputError "FILE: byte N: WHAT; REMEDY" if a part's header is damaged, claims more
/// than max_pixels, or claims more than the file's bytes can hold; if the first part is deep or subsampled; or if its
/// display window needs more than 256 MiB and more than 1032 times the file's bytes.
ExrClaims read_exr_claims(const ByteFile& file, std::uint64_t max_pixels);

}  // namespace tempolux
