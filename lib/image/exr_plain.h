// lib/image/exr_plain.h -- reads and writes lines of uncompressed EXR files without OpenEXR.
//
// OpenEXR reads and writes numbers byte by byte, 7 ns each; this reader and writer copy whole lines.
#pragma once

#include <string>

#include "lib/image/byte_file.h"
#include "lib/image/exr_claims.h"
#include "lib/image/image.h"

namespace tempolux {

/// Copies lines [first, last) of the data window to the image, which has the data window's size and the wanted
/// channels. Reads files of one part, in scan lines, uncompressed, whose wanted channels are float32 or uint32. False
/// if the file is of another kind or a line is damaged: the caller then reads all lines with OpenEXR, which reports
/// errors.
bool read_plain_lines(const ByteFile& file, const ExrClaims& claims, Image& image, int first, int last);

/// Lines [first, first + count) of the image as OpenEXR writes them uncompressed, in float32 and uint32, with the data
/// window at (0, 0). A line has its number and its bytes as int32, then its samples channel by channel in the order of
/// names.
std::string plain_lines(const Image& image, int first, int count);

}  // namespace tempolux
