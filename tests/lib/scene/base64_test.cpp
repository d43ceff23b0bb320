// Base64 against the test vectors of RFC 4648, section 10.
#include "lib/scene/base64.h"

#include <gtest/gtest.h>

#include <string>

namespace tempolux::gltf {
namespace {

std::string decoded(std::string_view text) {
  const auto bytes = base64_bytes(text);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "refused";
}

TEST(Base64, DecodesTheVectorsOfTheStandard) {
  EXPECT_EQ(decoded(""), "");
  EXPECT_EQ(decoded("Zg=="), "f");
  EXPECT_EQ(decoded("Zm8="), "fo");
  EXPECT_EQ(decoded("Zm9v"), "foo");
  EXPECT_EQ(decoded("Zm9vYg"), "foob");
  EXPECT_EQ(decoded("Zm9vYmFy"), "foobar");
}

TEST(Base64, DecodesEveryDigit) {
  EXPECT_EQ(decoded("+/+/"), "\xfb\xff\xbf");
  EXPECT_EQ(decoded("0189"), "\xd3\x5f\x3d");
}

TEST(Base64, OtherCharactersAreRefused) {
  for (const char* text : {"Zm9v!", "Zm 9v", "Zm9-", "Zm9_"}) EXPECT_EQ(decoded(text), "refused") << text;
}

}  // namespace
}  // namespace tempolux::gltf
