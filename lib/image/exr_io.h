// lib/image/exr_io.h -- reads and writes OpenEXR frames; exr_io.cpp is the only user of OpenEXR.
//
// OpenEXR's own threads are off. Our parallel loops, which obey ThreadLimit, compress and decompress slabs of lines;
// the slabs are joined in order. The bytes are the same as OpenEXR would write.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "lib/image/image.h"

namespace tempolux {

/// How save_exr() stores samples.
struct ExrWriteOptions {
  /// Writes colours (is_colour) as float16, rounded to nearest, ties to even; InputError for |value| > 65504. All other
  /// channels keep 32 bits.
  bool half = false;
  bool zip = true;  ///< compresses the samples
};

/// Writes an EXR of one part, in scan lines from the top, channels sorted by name (formats/frames/frames.md). The file
/// is created at exactly this path and written from front to back without seeking, so a pipe works. It is neither
/// synced nor renamed; tools/common/output.h does both. Equal images give equal files for any number of threads. Floats
/// keep their bits, including -0 and denormals.
///
/// Attributes: text as strings, but for those of mattes without channels (describes_missing_mattes); numbers as
/// doubles, framesPerSecond as OpenEXR's rational (23.976 becomes 24000/1001); the matrices worldToCamera and
/// worldToNDC as 4x4 floats, as in the standard, other matrices as 4x4 doubles.
///
/// Throws ResourceError if the file cannot be written. Throws InputError "FILE: channel C: pixel (x, y): ..." for NaN
/// in any channel, for infinity in any channel except Z (there +infinity means no surface), and for a number or matrix
/// that is not finite; std::invalid_argument if sizes do not match, or a name is empty, over 255 bytes or used twice.
/// Nothing is written in these cases. Memory: the compressed file, besides the image.
void save_exr(const std::string& path, const Image& image, const ExrWriteOptions& options = {});

/// What load_exr() reads and accepts.
struct ExrReadOptions {
  std::uint64_t max_pixels = 512ull << 20;           ///< limit of the data window and of the display window
  bool allow_nan = false;                            ///< accepts NaN in all channels, and infinity in colours
  bool only_rgb = false;                             ///< if the file has R, G and B, reads only these
  std::function<bool(const std::string&)> wanted{};  ///< true for the names of the channels to read; empty: all
  bool our_names = false;  ///< translates channel names of other programs (foreign_names.h) before it asks `wanted`
};

/// Reads a scan-line or tiled EXR: the first part of a multi-part file, the full size of mip maps. Reads all channels
/// in the order of their names, half and float as float, uint as ids; and string, double, float, int, rational and
/// matrix attributes. The image is the display window: pixels outside it are dropped; pixels outside the data window
/// are empty: 0 in every channel, but Z is +inf and id.object FFFFFFFF hex.
///
/// Sizes are checked against max_pixels and against the file's bytes before memory is allocated for them. Throws
/// InputError "FILE: PLACE: WHAT; REMEDY", one line, for a file that is incomplete, truncated, damaged, deep or
/// subsampled, and for NaN or (in R, G, B, A of any layer) infinity unless allowed. EXR has no checksum: a flipped bit
/// in uncompressed samples is not detected.
Image load_exr(const std::string& path, const ExrReadOptions& options = {});

}  // namespace tempolux
