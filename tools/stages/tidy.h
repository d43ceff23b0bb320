// tools/stages/tidy.h -- removes temporary files of killed runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tempolux::tools {

struct Tidied {
  std::size_t removed = 0, kept = 0;  ///< kept: files of processes that may still run
  std::uintmax_t bytes = 0;           ///< of the removed files
};

/// Removes temporary files of Output (`.NAME.tmp.HOST.PROCESS`) from a folder and its subfolders: files of this host
/// whose process has ended and whose lock is free, and files of other hosts that were not written for a day. Other
/// files stay; symbolic links are not followed. Throws InputError if the path is not a folder.
Tidied tidy(const std::string& folder);

}  // namespace tempolux::tools
