// lib/image/exr_plain.h -- lines of EXR files that are not compressed, read and written without OpenEXR.
//
// OpenEXR takes numbers byte by byte from a file and puts them so into one: 7 ns for each. Here lines are copied.
#pragma once

#include <string>

#include "lib/image/byte_file.h"
#include "lib/image/exr_claims.h"
#include "lib/image/image.h"

namespace tempolux {

/// Lines [first, last) of the data window into the image, which has its size and some of its channels. False if this is
/// not for here, or a line is not where and what it should be: nothing that counts was written, OpenEXR reads them or
/// says what is wrong. For here are files of one part, in lines, without compression, whose channels of the image are
/// float32 or uint32.
bool read_plain_lines(const ByteFile& file, const ExrClaims& claims, Image& image, int first, int last);

/// Lines [first, first + count) of the image, its data window at (0, 0), as OpenEXR writes them without compression,
/// float32 and uint32: for each line int32 line, int32 bytes, and its samples channel after channel in the order of
/// names.
std::string plain_lines(const Image& image, int first, int count);

}  // namespace tempolux
