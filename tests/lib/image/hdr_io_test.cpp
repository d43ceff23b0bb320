// Radiance pictures: the three ways their lines are stored, exposure, and damage.
#include "lib/image/hdr_io.h"

#include "formats/error.h"
#include "lib/image/any_io.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

std::string header(const std::string& size, const std::string& more = "") {
  return "#?RADIANCE\n# made by hand\n" + more + "FORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
}

/// Two pixels: (1, 0.5, 0.25) has exponent byte 129 (2^(129-136) = 1/128) and mantissas 128, 64, 32.
std::string tiny() { return header("-Y 1 +X 2") + std::string("\x80\x40\x20\x81\x80\x80\x80\x8b", 8); }

Image load(const std::string& bytes, std::uint64_t max_pixels = 1 << 20) {
  const Folder folder;
  put_bytes(folder / "a.img", bytes);
  return load_image(folder / "a.img", max_pixels);
}

TEST(RadianceHdr, MantissaTimesPowerOfTwo) {
  const Image image = load(tiny());
  ASSERT_EQ(image.width, 2);
  ASSERT_EQ(image.height, 1);
  EXPECT_EQ(image.find("R")->values, (std::vector<float>{1, 1024}));
  EXPECT_EQ(image.find("G")->values, (std::vector<float>{0.5f, 1024}));
  EXPECT_EQ(image.find("B")->values, (std::vector<float>{0.25f, 1024}));
  EXPECT_EQ(load(header("-Y 1 +X 1") + std::string("\xff\xff\xff\0", 4)).find("G")->values[0], 0);  // e = 0 is black
}

TEST(RadianceHdr, ExposureIsDividedOut) {
  const std::string bytes = header("-Y 1 +X 1", "EXPOSURE=2\nEXPOSURE=4\n") + "\x80\x40\x20\x81";
  EXPECT_EQ(load(bytes).find("R")->values[0], 0.125f);
}

TEST(RadianceHdr, PlanesRunsAndPixelsSayTheSame) {
  // Eight pixels by planes: red eight times 80 hex, green 1..8 one by one, blue a run and the rest, exponent 88 hex.
  const std::string planes = header("-Y 1 +X 8") + std::string("\x02\x02\x00\x08", 4) + "\x88\x80" +
                             "\x08\x01\x02\x03\x04\x05\x06\x07\x08" + "\x86\x10\x02\x20\x30" + "\x88\x88";
  std::string flat = header("-Y 1 +X 8");
  for (int x = 0; x < 8; ++x)
    flat += std::string("\x80") + char(x + 1) + (x < 6 ? "\x10" : x == 6 ? "\x20" : "\x30") + "\x88";
  EXPECT_EQ(load(planes).channels, load(flat).channels);
  EXPECT_EQ(load(planes).find("G")->values[7], 8);
  // Old runs: a pixel, then (1, 1, 1, 2) and (1, 1, 1, 1): 2 + 256 more of it.
  const std::string runs = header("-Y 1 +X 259") + "\x10\x20\x30\x88\x01\x01\x01\x02\x01\x01\x01\x01";
  EXPECT_EQ(load(runs).find("B")->values, std::vector<float>(259, 48));
}

TEST(RadianceHdr, DamageIsOneLineNeverACrash) {
  const auto message = [](const std::string& bytes) {
    const std::string text = message_of<InputError>([&] { load(bytes); });
    EXPECT_NE(text.find("a.img: byte "), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return text;
  };
  for (std::size_t size = 11; size < tiny().size(); ++size) message(tiny().substr(0, size));
  for (std::size_t at = 11; at < tiny().size(); ++at) {
    std::string bytes = tiny();
    bytes[at] ^= 0x11;
    message_of<InputError>([&] { load(bytes); });
  }
  EXPECT_NE(message(header("-Y 30000 +X 30") + "abcd").find("more pixels than its bytes"), std::string::npos);
  EXPECT_NE(message(header("-Y 30000 +X 30000") + "abcd").find("size out of range"), std::string::npos);
  EXPECT_NE(message(header("+Y 1 +X 1") + "abcd").find("save it upright"), std::string::npos);
  EXPECT_NE(message("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd").find("xyze"), std::string::npos);
  EXPECT_NE(message(header("-Y 1 +X 1", "EXPOSURE=0\n") + "abcd").find("not an exposure"), std::string::npos);
  message(header("-Y 1 +X 8") + std::string("\x02\x02\x00\x08\x89\x01", 6));  // a run of 9 in a line of 8
  message(header("-Y 1 +X 8") + std::string("\x02\x02\x00\x09\x88\x01", 6));  // a line of 9
  message(header("-Y 1 +X 8") + "\x01\x01\x01\x01");                          // a run of nothing before it
}

}  // namespace
}  // namespace tempolux
