// lib/image/exr_io.h -- frames to and from OpenEXR; exr_io.cpp is the only user of OpenEXR.
//
// OpenEXR's own threads stay at 0: slabs of lines are compressed and decompressed in our parallel loops,
// which obey ThreadLimit, and joined in order. The bytes are those OpenEXR writes in one go.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "lib/image/image.h"

namespace tempolux {

struct ExrWriteOptions {
  bool half = false;  ///< channels whose last name is R, G, B or A as float16 (nearest, ties to even);
                      ///< InputError for |value| > 65504. Z, N, P, motion and all others keep 32 bits.
  enum class Compression { none, zip } compression = Compression::zip;
};

/// Writes one scan-line EXR, single part, top line first, channels sorted by name (formats/frames/frames.md).
/// The file is created at exactly this path, front to back without seeking (a pipe will do), and not synced
/// or renamed: callers use an output that does (tools/common/output.h). No time stamp, no host name: equal images
/// give equal files, for any number of threads. Floats keep their bits, -0 and denormals included.
///
/// Attributes: text as strings; numbers as doubles, framesPerSecond as OpenEXR's rational (23.976 becomes
/// 24000/1001); matrices worldToCamera and worldToNDC as 4x4 floats, as the standard has them, any other as
/// 4x4 doubles.
///
/// Throws ResourceError if it cannot be written; InputError "FILE: channel C: pixel (x, y): ..." for NaN in
/// any channel and for infinity in any but Z (there +infinity is "nothing") and for a number or matrix that
/// is not finite; std::invalid_argument if sizes do not fit, a name is empty, over 255 bytes or there twice.
/// Nothing is written then. Memory: the compressed file, besides the image.
void save_exr(const std::string& path, const Image& image, const ExrWriteOptions& options = {});

struct ExrReadOptions {
  std::uint64_t max_pixels = 512ull << 20;           ///< of the data window and of the display window
  bool allow_nan = false;                            ///< NaN anywhere and infinity in colour are let through
  bool only_rgb = false;                             ///< of a file that has R, G and B these alone
  std::function<bool(const std::string&)> wanted{};  ///< which channels, by their names; empty: all
  bool our_names = false;  ///< channels of other programs get our names (foreign_names.h); `wanted` is asked by these
};

/// Reads a scan-line or tiled single-part EXR (of a multi-part file: the first part; of mip maps: the full
/// size), all channels, in the order of their names, half and float as float, uint as ids; string, double,
/// float, int, rational and matrix attributes. The image is the display window: pixels of the data window
/// outside it are cut off. Pixels outside the data window show nothing: 0 in every channel, Z +inf, id.object FFFFFFFF
/// hex.
///
/// Sizes are checked against max_pixels and against the file's bytes before anything is allocated by them.
/// Throws InputError "FILE: PLACE: WHAT; REMEDY", one line, for a file that is incomplete, truncated,
/// damaged, deep or subsampled, and for NaN or (in R, G, B, A of any layer) infinity unless allowed. EXR has
/// no checksum: a flipped bit in samples stored without compression is not noticed.
Image load_exr(const std::string& path, const ExrReadOptions& options = {});

/// 32 hexadecimal digits over size, channel names and samples (their bits: -0 is not 0); the channels' order,
/// the attributes and the compression do not count.
std::string digest_of(const Image& image);

}  // namespace tempolux
