// Mattes by name: published hashes, ranks, and what files hold of them.
#include "lib/image/cryptomatte.h"

#include <bit>
#include <cmath>

#include "lib/image/channel_groups.h"
#include "lib/image/exr_io.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

using namespace std::string_view_literals;

/// Published test values of MurmurHash3_x86_32. Meant to catch: a rest of one to three bytes that is read as signed or
/// from the wrong end, an embedded 0 that ends the text.
TEST(Cryptomatte, HashesArePublishedOnes) {
  EXPECT_EQ(murmur_hash(""), 0u);
  EXPECT_EQ(murmur_hash("\xff\xff\xff\xff"sv), 0x76293B50u);
  EXPECT_EQ(murmur_hash("\x21\x43\x65\x87"sv), 0xF55B516Bu);
  EXPECT_EQ(murmur_hash("\x21\x43\x65"sv), 0x7E4A8634u);
  EXPECT_EQ(murmur_hash("\x21\x43"sv), 0xA0F7B07Au);
  EXPECT_EQ(murmur_hash("\x21"sv), 0x72661CF4u);
  EXPECT_EQ(murmur_hash("\0\0\0\0"sv), 0x2362F9DEu);
  EXPECT_EQ(murmur_hash("\0\0\0"sv), 0x85F0B427u);
  EXPECT_EQ(murmur_hash("The quick brown fox jumps over the lazy dog"), 0x2E4FF723u);
}

/// Floats and manifests that Cryptomatte's specification and its own tests print.
TEST(Cryptomatte, NamesHaveTheSpecificationsFloats) {
  const auto value = [](std::string_view name) { return std::bit_cast<float>(matte_bits(name)); };
  EXPECT_EQ(value("hello"), 6.0705627102400005616e-17f);
  EXPECT_EQ(value("cube"), -4.08461912519e+15f);
  EXPECT_EQ(value("sphere"), 2.79018604383e+15f);
  EXPECT_EQ(value("plane"), 3.66557617593e-11f);
  EXPECT_EQ(value("m\xc3\xa4"
                  "dchen"),
            6.2361298211599995797e+25f);
  EXPECT_EQ(value("\xd1\x80\xd0\xb0\xd0\xb2\xd0\xbd\xd0\xb8\xd0\xbd\xd0\xb0"), -1.3192631212399999468e-25f);
  EXPECT_EQ(matte_bits("bunny"), 0x13851a76u);
  EXPECT_EQ(matte_bits("default"), 0x42c9679fu);
  EXPECT_EQ(matte_bits("bunny_porcelain_mat"), 0xb24b26d4u);
  // Exponents 0 and 255: with the plain hash the first is a denormal, which some programs flush to 0, and the second is
  // not a number.
  EXPECT_EQ(murmur_hash("n17"), 0x000738c5u);
  EXPECT_EQ(matte_bits("n17"), 0x008738c5u);
  EXPECT_EQ(murmur_hash("n535"), 0xff8d97efu);
  EXPECT_EQ(matte_bits("n535"), 0xff0d97efu);
  EXPECT_TRUE(std::isnormal(value("n17")) && std::isnormal(value("n535")));
}

TEST(Cryptomatte, EachMatteHasANameOfItsOwn) {
  const std::vector<std::string> made =
      matte_names({"Chair", "", "Chair", "Chair#4", "Chair", "a\tb", "object 1"}, "object");
  EXPECT_EQ(made,
            (std::vector<std::string>{"Chair", "object 1", "Chair#2", "Chair#4", "Chair#4#4", "a b", "object 1#6"}));
}

/// Eight mattes in a pixel of 10 samples: the six largest are kept, equal ones by number; a third of 3 samples is
/// rounded down, so that three thirds are not more than 1.
TEST(Cryptomatte, RanksGoByShareAndThenByNumber) {
  const std::vector<std::string> names{"a", "b", "c", "d", "e", "f", "g", "h"};
  Image image{2, 1, {}, {}, {}, {}};
  MatteChannels mattes("CryptoObject", names, image);
  std::vector<MatteCount> counts{{7, 1}, {6, 1}, {5, 1}, {4, 1}, {3, 1}, {2, 1}, {1, 1}, {0, 3}};
  mattes.set(0, counts, 10);
  std::vector<MatteCount> thirds{{2, 1}, {1, 1}, {0, 1}};
  mattes.set(1, thirds, 3);
  std::size_t rank = 0;
  double sum = 0;
  for (const char* layer : {"CryptoObject00", "CryptoObject01", "CryptoObject02"})
    for (const auto& [hash, share] : {std::pair{".R", ".G"}, {".B", ".A"}}) {
      EXPECT_EQ(std::bit_cast<std::uint32_t>(image.find(layer + std::string(hash))->values[0]),
                matte_bits(names[rank]));
      EXPECT_NEAR(image.find(layer + std::string(share))->values[0], rank == 0 ? 0.3 : 0.1, 1e-7);
      sum += double(image.find(layer + std::string(share))->values[1]);
      ++rank;
    }
  EXPECT_LE(sum, 1);
  EXPECT_GE(sum, 1 - 3 * 0x1p-25);
  mattes.describe(image);
  EXPECT_EQ(image.text["cryptomatte/3ae39a5/name"], "CryptoObject");
  EXPECT_EQ(image.text["cryptomatte/3ae39a5/hash"], "MurmurHash3_32");
  EXPECT_EQ(image.text["cryptomatte/3ae39a5/conversion"], "uint32_to_float32");
  EXPECT_EQ(image.text["cryptomatte/3ae39a5/manifest"].find("\"g\""), std::string::npos);
  EXPECT_EQ(image.text["cryptomatte/3ae39a5/manifest"].substr(0, 33), R"({"a":"3c2569b2","b":"95de7e03","c)");
}

/// Quotes and backslashes are escaped in the manifest, and the hash is of the plain name.
TEST(Cryptomatte, TheManifestIsJson) {
  const std::vector<std::string> names{"a\"b\\c"};
  Image image{1, 1, {}, {}, {}, {}};
  MatteChannels mattes("CryptoMaterial", names, image);
  std::vector<MatteCount> counts{{0, 1}};
  mattes.set(0, counts, 1);
  mattes.describe(image);
  char digits[9];
  std::snprintf(digits, sizeof digits, "%08x", matte_bits("a\"b\\c"));
  EXPECT_EQ(image.text["cryptomatte/be359d6/manifest"], R"({"a\"b\\c":")" + std::string(digits) + "\"}");
}

/// Mattes are no colours: --half leaves their bits alone. Their attributes go with their channels.
TEST(Cryptomatte, FilesKeepTheBitsAndDropAttributesWithoutChannels) {
  const std::vector<std::string> names{"cube"};  // its float is far above the largest half
  Image image{1, 1, {}, {}, {}, {}};
  image.add("R");
  MatteChannels mattes("CryptoObject", names, image);
  std::vector<MatteCount> counts{{0, 1}};
  mattes.set(0, counts, 3);
  mattes.describe(image);
  const Folder folder;
  save_exr(folder / "a.exr", image, {.half = true});
  Image read = load_exr(folder / "a.exr");
  EXPECT_EQ(std::bit_cast<std::uint32_t>(read.find("CryptoObject00.R")->values[0]), matte_bits("cube"));
  EXPECT_EQ(read.find("CryptoObject00.G")->values[0], image.find("CryptoObject00.G")->values[0]);
  ASSERT_EQ(matte_layers_in(read).size(), 1u);
  EXPECT_EQ(matte_layers_in(read)[0].name, "CryptoObject");
  EXPECT_EQ(matte_layers_in(read)[0].ranks, 6u);
  EXPECT_TRUE(read.layers() == std::vector<std::string>{});  // R alone is no layer, and mattes are none
  keep_channels({"R"}, read);
  save_exr(folder / "b.exr", read);
  for (const auto& [name, value] : load_exr(folder / "b.exr").text)
    EXPECT_FALSE(name.starts_with("cryptomatte/")) << name;
}

TEST(Cryptomatte, ChannelsAreFoundByTheirLayer) {
  for (const char* name :
       {"CryptoObject00.R", "CryptoMaterial02.A", "ViewLayer.CryptoAsset01.G", "crypto_object00.red"}) {
    EXPECT_TRUE(is_matte(name)) << name;
    EXPECT_TRUE(is_in_group(name, "cryptomatte")) << name;
    EXPECT_FALSE(is_colour(name)) << name;
  }
  for (const char* name : {"R", "direct.R", "Crypto", "CryptoView.Combined.R", "id.object"})
    EXPECT_FALSE(is_matte(name)) << name;
}

}  // namespace
}  // namespace tempolux
