#include "formats/crc32.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tempolux::formats {
namespace {

/// The definition, bit by bit.
std::uint32_t crc32_by_bits(const unsigned char* p, std::size_t size) {
  std::uint32_t r = ~0u;
  for (std::size_t i = 0; i < size; ++i) {
    r ^= p[i];
    for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1) ? 0xedb88320u : 0u);
  }
  return ~r;
}

std::vector<unsigned char> bytes_of(std::size_t size) {
  std::vector<unsigned char> bytes(size);
  std::uint32_t state = 1;
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>((state = state * 1664525u + 1013904223u) >> 24);
  return bytes;
}

// Check value of the CRC catalogue ("123456789"), and values of zlib.crc32 in Python.
TEST(Crc32, KnownVectors) {
  const std::string zeros(100, '\0'), as(1000, 'a');
  for (auto* crc : {&crc32, &crc32_tables}) {
    EXPECT_EQ(crc("", 0, 0), 0u);
    EXPECT_EQ(crc("123456789", 9, 0), 0xcbf43926u);
    EXPECT_EQ(crc(zeros.data(), zeros.size(), 0), 0x9988c6cau);
    EXPECT_EQ(crc(as.data(), as.size(), 0), 0x9a38da03u);
  }
}

TEST(Crc32, BothWaysAgreeWithTheDefinitionForEveryLengthAndAlignment) {
  if (!crc32_has_folding()) GTEST_SKIP() << "this processor has no carry-less multiplication";
  const auto bytes = bytes_of(700);
  for (std::size_t first = 0; first < 17; ++first)
    for (std::size_t size = 0; size + first <= bytes.size(); size += size < 300 ? 1 : 37) {
      const std::uint32_t expected = crc32_by_bits(&bytes[first], size);
      ASSERT_EQ(crc32_tables(&bytes[first], size), expected) << first << " " << size;
      ASSERT_EQ(crc32_folded(&bytes[first], size), expected) << first << " " << size;
    }
}

TEST(Crc32, ContinuesFromAnyCut) {
  const auto bytes = bytes_of(400);
  const std::uint32_t whole = crc32(bytes.data(), bytes.size());
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut)
    ASSERT_EQ(crc32(bytes.data() + cut, bytes.size() - cut, crc32(bytes.data(), cut)), whole) << cut;
}

}  // namespace
}  // namespace tempolux::formats
