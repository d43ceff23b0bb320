// formats/crc32.h -- CRC-32 as in zlib, gzip and ISO 3309 (polynomial 0x04C11DB7, reflected).
#pragma once

#include <cstddef>
#include <cstdint>

namespace tempolux::formats {

/// CRC of `size` bytes; `crc` is that of the bytes before them (0 at the start), as zlib's crc32().
/// Carry-less multiplication where the processor has it, else tables; the same value either way.
std::uint32_t crc32(const void* data, std::size_t size, std::uint32_t crc = 0);

/// The two ways, for tests and timings. crc32_folded must only be called where crc32_has_folding().
std::uint32_t crc32_tables(const void* data, std::size_t size, std::uint32_t crc = 0);
std::uint32_t crc32_folded(const void* data, std::size_t size, std::uint32_t crc = 0);
bool crc32_has_folding();

}  // namespace tempolux::formats
