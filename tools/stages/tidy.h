// tools/stages/tidy.h -- removes what killed runs have left.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tempolux::tools {

struct Tidied {
  std::size_t removed = 0, kept = 0;  ///< kept: of a process that may still live
  std::uintmax_t bytes = 0;           ///< of the removed
};

/// Removes temporary files of our outputs (`.NAME.tmp.HOST.PROCESS`, Output) from a folder and all folders in it:
/// those of this host whose process is gone and whose lock is free, and those of other hosts not written to for
/// `other_hosts_s` seconds. Nothing else is touched; symbolic links are not followed. Throws InputError if it is
/// no folder.
Tidied tidy(const std::string& folder, double other_hosts_s);

}  // namespace tempolux::tools
