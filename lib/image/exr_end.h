// lib/image/exr_end.h -- looks at the end of an OpenEXR file, to find out cheaply whether it is whole.
#pragma once

#include <string>

namespace tempolux {

/// Throws InputError "FILE: PLACE: WHAT; REMEDY" if the file is cut off or its writer did not finish: if the header or
/// the offset table is incomplete, or the file ends before the last chunk does. Reads the header, the table and the
/// head of the last chunk. A tiled file, and one of several parts, is read as a whole.
void check_exr_end(const std::string& path);

}  // namespace tempolux
