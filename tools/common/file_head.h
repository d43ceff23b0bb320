// tools/common/file_head.h -- reads the first bytes of a file, which determine its type.
#pragma once

#include <string>

namespace tempolux::tools {

/// At most 16 bytes. "-" is standard input (a file or a pipe), from which the bytes can be read again. Throws
/// InputError if the file cannot be opened.
std::string head_of(const std::string& path);

/// A name under which `path` can be read more than once: a regular file keeps its name. Any other file (a named pipe, a
/// shell's /dev/fd/63) becomes standard input, "-", so that its first bytes can be looked at before it is read. Throws
/// InputError if it cannot be opened.
std::string readable_name(const std::string& path);

}  // namespace tempolux::tools
