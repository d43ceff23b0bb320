// tools/common/file_head.h -- the first bytes of a file, by which its type is told.
#pragma once

#include <string>

namespace tempolux::tools {

/// At most 16 bytes. "-" is standard input, of which they stay to be read: of a file, or of a pipe. InputError if the
/// file cannot be opened.
std::string head_of(const std::string& path);

/// A name to read `path` by, once or more: a regular file's is its own; what is none (a named pipe, /dev/fd/63 of a
/// shell) becomes standard input, "-", so that its head can be looked at before it is read. InputError if it cannot be
/// opened.
std::string readable_name(const std::string& path);

}  // namespace tempolux::tools
