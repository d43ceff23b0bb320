// formats/base_file.h -- the base of an overlay: the file that the overlay changes. The header keys `base` and
// `base-digest` name it (photons.md, section 8; radsamples.md, section 6).
#pragma once

#include <string>
#include <string_view>

#include "formats/text_header.h"

namespace tempolux::formats {

inline bool is_digest(std::string_view text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == text.npos;
}
inline bool is_base_name(std::string_view text) {
  return !text.empty() && text != "." && text != ".." && text.find('/') == text.npos && is_printable(text);
}

/// Checks the values of the two keys: returns the fault, or "" if there is none. If both are empty, the file is no
/// overlay.
inline std::string_view fault_of_base(std::string_view name, std::string_view digest) {
  if (name.empty() != digest.empty()) return "base and base-digest do not stand together";
  if (!name.empty() && !is_base_name(name)) return "base is not the name of a file without folder";
  if (!name.empty() && !is_digest(digest)) return "base-digest is not 32 hexadecimal digits";
  return "";
}

/// Path of the base of the overlay `path`. The base lies in the overlay's folder; if the overlay comes from a pipe
/// ("-"), in the current folder.
inline std::string path_of_base(const std::string& path, const std::string& name) {
  return path.substr(0, path.rfind('/') + 1) + name;
}

}  // namespace tempolux::formats
