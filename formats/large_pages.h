// formats/large_pages.h -- memory for many values: asks the system to hand it out in large pages.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

namespace tempolux::formats {

/// Hint before a block of `bytes` is first written: in pages of 2 MiB there is one page fault where there were 512,
/// which one thread would take while the others wait. Only whole large pages inside the block are concerned, so memory
/// around it stays as it is, and a system that has none ignores the hint. No error: it is never needed.
inline void prefer_large_pages(void* first, std::size_t bytes) {
  constexpr std::uintptr_t page = std::uintptr_t(2) << 20;
  const auto begin = (reinterpret_cast<std::uintptr_t>(first) + page - 1) & ~(page - 1);
  const auto end = (reinterpret_cast<std::uintptr_t>(first) + bytes) & ~(page - 1);
  if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace tempolux::formats
