// lib/image/exr_io.h -- reads and writes OpenEXR frames; exr_io.cpp is the only user of OpenEXR.
//
// OpenEXR's own threads are off: our parallel loops, which obey ThreadLimit, compress and decompress slabs of lines and
// join them in order. The bytes are the same as OpenEXR's.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "lib/image/image.h"

namespace tempolux {

struct ExrWriteOptions {
  bool half = false;  ///< channels whose last name is R, G, B or A as float16 (nearest, ties to even);
                      ///< InputError for |value| > 65504. Z, N, P, motion and all others keep 32 bits.
  bool zip = true;    ///< compress the samples
};

/// Writes one scan-line EXR, single part, top line first, channels sorted by name (formats/frames/frames.md). The file
/// is created at exactly this path and written from front to back without seeking (a pipe works). It is neither synced
/// nor renamed: callers use an output that does both (tools/common/output.h). Without time stamp or host name, equal
/// images give equal files for any number of threads. Floats keep their bits, including -0 and denormals.
///
/// Attributes: text as strings; numbers as doubles, framesPerSecond as OpenEXR's rational (23.976 becomes 24000/1001);
/// the matrices worldToCamera and worldToNDC as 4x4 floats, as in the standard, any other as 4x4 doubles.
///
/// Throws ResourceError if the file cannot be written. Throws InputError "FILE: channel C: pixel (x, y): ..." for NaN
/// in any channel, for infinity in any channel except Z (there +infinity means no surface), and for a number or matrix
/// that is not finite; std::invalid_argument if sizes do not match, or a name is empty, over 255 bytes or used twice.
/// Nothing is written in these cases. Memory: the compressed file, besides the image.
void save_exr(const std::string& path, const Image& image, const ExrWriteOptions& options = {});

struct ExrReadOptions {
  std::uint64_t max_pixels = 512ull << 20;           ///< for the data window and for the display window
  bool allow_nan = false;                            ///< accept NaN anywhere, and infinity in colour
  bool only_rgb = false;                             ///< if the file has R, G and B, read only these
  std::function<bool(const std::string&)> wanted{};  ///< which channels to read, by name; empty: all
  bool our_names = false;  ///< translate channel names of other programs (foreign_names.h) before asking `wanted`
};

/// Reads a scan-line or tiled EXR: of a multi-part file the first part, of mip maps the full size. Reads all channels
/// in the order of their names, half and float as float, uint as ids; and string, double, float, int, rational and
/// matrix attributes. The image is the display window: pixels of the data window outside it are cut off, pixels outside
/// the data window are empty (0 in every channel, Z +inf, id.object FFFFFFFF hex).
///
/// Sizes are checked against max_pixels and against the file's bytes before memory is allocated for them. Throws
/// InputError "FILE: PLACE: WHAT; REMEDY", one line, for a file that is incomplete, truncated, damaged, deep or
/// subsampled, and for NaN or (in R, G, B, A of any layer) infinity unless allowed. EXR has no checksum: a flipped bit
/// in uncompressed samples is not detected.
Image load_exr(const std::string& path, const ExrReadOptions& options = {});

/// 32 hexadecimal digits: a hash of size, channel names and samples (of their bits: -0 differs from 0). The order of
/// channels, attributes and compression do not count.
std::string digest_of(const Image& image);

}  // namespace tempolux
