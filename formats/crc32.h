// formats/crc32.h -- CRC-32 as in zlib, gzip and ISO 3309 (polynomial 0x04C11DB7, reflected).
#pragma once

#include <cstddef>
#include <cstdint>

namespace tempolux::formats {

/// CRC of `size` bytes. `crc` is the CRC of the bytes before them, 0 at the start, as in zlib's crc32(). Uses
/// carry-less multiplication if the processor has it, else tables; both give the same value.
std::uint32_t crc32(const void* data, std::size_t size, std::uint32_t crc = 0);

/// The two implementations, for tests and timings. Call crc32_folded only if crc32_has_folding() is true.
std::uint32_t crc32_tables(const void* data, std::size_t size, std::uint32_t crc = 0);
std::uint32_t crc32_folded(const void* data, std::size_t size, std::uint32_t crc = 0);
bool crc32_has_folding();

}  // namespace tempolux::formats
