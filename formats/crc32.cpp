// formats/crc32.cpp -- computes CRC-32 with 16 tables, or by folding with carry-less multiplication.
//
// Folding: V. Gopal et al., "Fast CRC Computation for Generic Polynomials Using PCLMULQDQ Instruction", Intel, 2009.
// Tables: M. Kounavis, F. Berry, "A Systematic Approach to Building High Performance Software-Based CRC Generators",
// ISCC 2005, with 16 bytes per step.
#include "formats/crc32.h"

#include <immintrin.h>

#include <array>
#include <cstring>

namespace tempolux::formats {
namespace {

using Tables = std::array<std::array<std::uint32_t, 256>, 16>;

/// tables[k][b] is the register after byte b and k zero bytes, if the register was zero before.
constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t r = b;
    for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1) ? 0xedb88320u : 0u);
    tables[0][b] = r;
  }
  for (std::size_t k = 1; k < 16; ++k)
    for (std::uint32_t b = 0; b < 256; ++b) tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 255];
  return tables;
}
constexpr Tables kTables = make_tables();

/// Returns the register (not inverted) after `size` more bytes.
std::uint32_t advance(std::uint32_t r, const unsigned char* p, std::size_t size) {
  for (; size >= 16; size -= 16, p += 16) {
    std::array<std::uint32_t, 4> w;
    std::memcpy(w.data(), p, 16);
    w[0] ^= r;
    r = 0;
    for (std::size_t i = 0; i < 4; ++i)
      r ^= kTables[15 - 4 * i][w[i] & 255] ^ kTables[14 - 4 * i][(w[i] >> 8) & 255] ^
           kTables[13 - 4 * i][(w[i] >> 16) & 255] ^ kTables[12 - 4 * i][w[i] >> 24];
  }
  for (; size > 0; --size, ++p) r = (r >> 8) ^ kTables[0][(r ^ *p) & 255];
  return r;
}

__attribute__((target("pclmul"))) inline __m128i load(const unsigned char* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}

/// Moves x forward by the distance whose remainders are in k, and adds the 16 bytes at the new place.
__attribute__((target("pclmul"))) inline __m128i fold(__m128i x, __m128i k, __m128i next) {
  return _mm_xor_si128(_mm_xor_si128(_mm_clmulepi64_si128(x, k, 0x00), _mm_clmulepi64_si128(x, k, 0x11)), next);
}

/// The same as advance(), for size >= 64.
__attribute__((target("pclmul"))) std::uint32_t advance_folded(std::uint32_t r, const unsigned char* p,
                                                               std::size_t size) {
  // x^(512+32), x^(512-32) and x^(128+32), x^(128-32) mod P, reflected [Gopal 2009, table 2]
  const __m128i by_64 = _mm_set_epi64x(0x1c6e41596, 0x154442bd4);
  const __m128i by_16 = _mm_set_epi64x(0x0ccaa009e, 0x1751997d0);
  __m128i x0 = _mm_xor_si128(load(p), _mm_cvtsi32_si128(int(r)));
  __m128i x1 = load(p + 16), x2 = load(p + 32), x3 = load(p + 48);
  p += 64;
  size -= 64;
  for (; size >= 64; size -= 64, p += 64) {
    x0 = fold(x0, by_64, load(p));
    x1 = fold(x1, by_64, load(p + 16));
    x2 = fold(x2, by_64, load(p + 32));
    x3 = fold(x3, by_64, load(p + 48));
  }
  __m128i x = fold(fold(fold(x0, by_16, x1), by_16, x2), by_16, x3);
  for (; size >= 16; size -= 16, p += 16) x = fold(x, by_16, load(p));
  // The remaining 16 bytes have the same remainder as all bytes so far.
  std::array<unsigned char, 16> rest;
  _mm_storeu_si128(reinterpret_cast<__m128i*>(rest.data()), x);
  return advance(advance(0, rest.data(), rest.size()), p, size);
}

}  // namespace

bool crc32_has_folding() { return __builtin_cpu_supports("pclmul"); }

std::uint32_t crc32_tables(const void* data, std::size_t size, std::uint32_t crc) {
  return ~advance(~crc, static_cast<const unsigned char*>(data), size);
}

std::uint32_t crc32_folded(const void* data, std::size_t size, std::uint32_t crc) {
  if (size < 64) return crc32_tables(data, size, crc);
  return ~advance_folded(~crc, static_cast<const unsigned char*>(data), size);
}

std::uint32_t crc32(const void* data, std::size_t size, std::uint32_t crc) {
  static const bool folding = crc32_has_folding();
  return folding ? crc32_folded(data, size, crc) : crc32_tables(data, size, crc);
}

}  // namespace tempolux::formats
