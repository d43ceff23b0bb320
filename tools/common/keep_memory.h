// tools/common/keep_memory.h -- memory that is freed is used again.
#pragma once

#include <malloc.h>

namespace tempolux::tools {

/// Arrays of the size of pictures come and go in tools that work on one picture after the other. By default each is
/// given back to the system and comes anew, cleared, page by page: half of the time of such a tool
/// (docs/methods/st-filter.md 8). From here on the process keeps what it has. GNU's malloc; another one ignores it.
inline void keep_freed_memory() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_MAX, 0);
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
  ::mallopt(M_TOP_PAD, 64 << 20);
#endif
}

}  // namespace tempolux::tools
