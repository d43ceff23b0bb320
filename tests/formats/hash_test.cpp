#include "formats/hash.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace tempolux {
namespace {

/// The buffer of xxHash's own sanity check: tests/sanity_test.c and cli/xsum_sanity_check.c.
std::string sanity_buffer(std::size_t size) {
  std::string bytes(size, '\0');
  std::uint64_t state = 2654435761u;
  for (char& byte : bytes) {
    byte = char(state >> 56);
    state *= 11400714785074694797ull;
  }
  return bytes;
}

// XXH3 of 128 bits, seed 0, high half first, as xxHash prints it. The first four from its sanity check.
TEST(Hash, KnownVectorsOfXxh3) {
  EXPECT_EQ(hash_hex(""), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(hash_hex(sanity_buffer(1)), "a6cd5e9392000f6ac44bdff4074eecdb");
  EXPECT_EQ(hash_hex(sanity_buffer(6)), "082afe0b8162d12a3e7039bdda43cfc6");
  EXPECT_EQ(hash_hex(sanity_buffer(12)), "6e3efd8fc7802b18061a192713f69ad9");
  EXPECT_EQ(hash_hex("abc"), "06b05ab6733a618578af5f94892f3950");
}

TEST(Hash, DoesNotDependOnHowTheBytesWereCut) {
  const std::string bytes = sanity_buffer(3000);
  for (std::size_t cut : {0, 1, 255, 256, 1024, 2999}) {
    Hasher hasher;
    hasher.add_bytes(bytes.data(), cut);
    hasher.add_bytes(bytes.data() + cut, bytes.size() - cut);
    EXPECT_EQ(hasher.hex(), hash_hex(bytes));
  }
}

TEST(Hash, StringsAndArraysCarryTheirLength) {
  const auto hash_of = [](std::string_view a, std::string_view b) {
    Hasher hasher;
    hasher.add(a);
    hasher.add(b);
    return hasher.hex();
  };
  EXPECT_NE(hash_of("ab", "c"), hash_of("a", "bc"));
  EXPECT_NE(hash_of("", "abc"), hash_of("abc", ""));
  const std::array<std::uint16_t, 2> values{1, 2};
  Hasher array, cut;
  array.add_array(std::span<const std::uint16_t>(values));
  cut.add_array(std::span<const std::uint16_t>(values).first(1));
  cut.add_array(std::span<const std::uint16_t>(values).last(1));
  EXPECT_NE(array.hex(), cut.hex());
}

TEST(Hash, MayBeReadBeforeItIsComplete) {
  Hasher hasher;
  hasher.add_bytes("ab", 2);
  EXPECT_EQ(hasher.hex(), hash_hex("ab"));
  hasher.add_bytes("c", 1);
  EXPECT_EQ(hasher.hex(), hash_hex("abc"));
}

}  // namespace
}  // namespace tempolux
