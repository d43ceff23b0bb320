// formats/large_pages.h -- asks the system for large pages for a large array.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

namespace tempolux::formats {

/// Asks the system to use pages of 2 MiB for a block of `bytes`. Call it before the block is first written. A large
/// page causes one page fault instead of 512; while one thread waits for a fault, others wait, too. Only whole large
/// pages inside the block change, so memory around it is not affected. A system without large pages ignores the
/// request, so there is no error.
inline void prefer_large_pages(void* first, std::size_t bytes) {
  constexpr std::uintptr_t page = std::uintptr_t(2) << 20;
  const auto begin = (reinterpret_cast<std::uintptr_t>(first) + page - 1) & ~(page - 1);
  const auto end = (reinterpret_cast<std::uintptr_t>(first) + bytes) & ~(page - 1);
  if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace tempolux::formats
