// lib/image/exr_claims.h -- what an EXR header claims, read without OpenEXR, checked against the file's size.
//
// OpenEXR allocates by the numbers it finds in a header: offset tables, attributes, line buffers. So the
// header is walked here first, in constant memory, and nothing is handed on that the file is too short to
// hold.
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

struct ExrClaims {
  struct ClaimedChannel {
    std::string name;
    std::int32_t type = 0;  ///< 0 uint, 1 half, 2 float
    std::int32_t x_sampling = 1, y_sampling = 1;
  };
  PixelWindow data, display;
  std::vector<ClaimedChannel> channels;
  std::int32_t compression = -1;                  ///< -1: attribute absent
  std::uint32_t tile_width = 0, tile_height = 0;  ///< 0: scan lines
  bool deep = false;
  bool multipart = false;
  std::uint64_t header_bytes = 0;        ///< of a file of one part: where its offset table begins
  std::int32_t lines_per_chunk() const;  ///< of scan-line parts
};

/// Claims of the first part. Throws InputError "FILE: byte N: WHAT; REMEDY" if any part's header is damaged
/// or claims more than max_pixels or more than the file's bytes can hold, or if the first part is deep or
/// subsampled, or shows its pixels in a display window of more than 256 MiB and 1032 times the file.
ExrClaims read_exr_claims(const ByteFile& file, std::uint64_t max_pixels);

}  // namespace tempolux
