#include "lib/core/sobol.h"

#include "lib/core/random.h"

namespace tempolux {
namespace {

/// x with the bits of each byte reversed.
template <class Bits>
Bits reverse_in_bytes(Bits x) {
  const Bits ones = ~Bits(0), fours = ones / 17, pairs = ones / 5, singles = ones / 3;
  x = (x & fours) << 4 | (x >> 4 & fours);
  x = (x & pairs) << 2 | (x >> 2 & pairs);
  return (x & singles) << 1 | (x >> 1 & singles);
}

std::uint32_t reverse_bits(std::uint32_t x) { return __builtin_bswap32(reverse_in_bytes(x)); }

/// Both halves of x, each with its bits reversed.
std::uint64_t reverse_halves(std::uint64_t x) {
  x = __builtin_bswap64(reverse_in_bytes(x));
  return x << 32 | x >> 32;
}

/// Laine-Karras style hash on reversed bits: each bit depends on itself and lower bits only. Constants: Vegdahl, "Owen
/// scrambling based hash functions", 2021.
std::uint32_t permute_low_to_high(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Computes the second Sobol dimension from the first, both with reversed bits: Pascal's triangle modulo 2 applied to
/// binary fractions, in five steps. Ahmed, "An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and
/// Compact", EGSR 2024.
std::uint32_t reversed_second(std::uint32_t x) {
  x ^= x >> 16;
  x ^= x >> 8 & 0x00ff00ffu;
  x ^= x >> 4 & 0x0f0f0f0fu;
  x ^= x >> 2 & 0x33333333u;
  return x ^ (x >> 1 & 0x55555555u);
}

/// Shuffles indices so that each aligned block of 2^k indices maps onto an aligned block. The result is also the first
/// Sobol dimension with reversed bits, on which scrambling works.
std::uint32_t shuffled(std::uint32_t index, std::uint32_t seed) {
  return reverse_bits(permute_low_to_high(reverse_bits(index), seed));
}

}  // namespace

// Owen scrambling permutes reversed bits, then reverses them: of both coordinates at once.
Vec2 sobol_owen_2d(std::uint32_t index, std::uint64_t key) {
  const std::uint64_t a = mix64(key), b = mix64(key ^ 0x5851f42d4c957f2dull);
  const std::uint32_t x = shuffled(index, std::uint32_t(a));
  const std::uint64_t both = reverse_halves(std::uint64_t(permute_low_to_high(x, std::uint32_t(a >> 32))) << 32 |
                                            permute_low_to_high(reversed_second(x), std::uint32_t(b)));
  return {unit_float(std::uint32_t(both >> 32)), unit_float(std::uint32_t(both))};
}

float sobol_owen_1d(std::uint32_t index, std::uint64_t key) {
  const std::uint64_t a = mix64(key);
  const std::uint32_t x = shuffled(index, std::uint32_t(a));
  return unit_float(reverse_bits(permute_low_to_high(x, std::uint32_t(a >> 32))));
}

}  // namespace tempolux
