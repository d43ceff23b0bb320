// Images of other formats: found by their first bytes, read by a helper, refused with a reason.
#include "lib/core/module_folders.h"
#include "lib/image/any_io.h"

#include <cmath>

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "lib/image/preview.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

/// CRC-32 as PNG wants it.
std::uint32_t crc(const std::string& bytes) {
  std::uint32_t value = ~0u;
  for (unsigned char byte : bytes) {
    value ^= byte;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1 ? 0xedb88320u : 0);
  }
  return ~value;
}
std::string big_endian(std::uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }
std::string png_chunk(const std::string& type, const std::string& data) {
  return big_endian(std::uint32_t(data.size())) + type + data + big_endian(crc(type + data));
}
/// A PNG of one row of filtered bytes, deflated as a stored block.
std::string png(std::uint32_t width, char bits, char colour, const std::string& samples,
                const std::string& extra = "") {
  const std::string row = '\0' + samples;
  std::uint32_t a = 1, b = 0;
  for (unsigned char byte : row) a = (a + byte) % 65521, b = (b + a) % 65521;
  const auto size = std::uint16_t(row.size());
  const std::string data =
      std::string("\x78\x01\x01", 3) + raw(size) + raw(std::uint16_t(~size)) + row + big_endian(b << 16 | a);
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR", big_endian(width) + big_endian(1) + bits + colour + std::string(3, '\0')) + extra +
         png_chunk("IDAT", data) + png_chunk("IEND", "");
}

bool helper_is_there() {
  for (const std::string& folder : default_module_folders())
    if (std::filesystem::exists(folder + "/tempolux-oiio")) return true;
  return false;
}

TEST(AnyImage, ExrAndPngAreKnownByTheirBytesNotTheirNames) {
  const Folder folder;
  Image image;
  image.width = image.height = 1;
  for (const char* name : {"B", "G", "R"}) image.add(name).values = {0.25f};
  save_exr(folder / "exr.png", image);
  EXPECT_EQ(load_image(folder / "exr.png").channels, image.channels);
  save_png(folder / "png.exr", {1, 1, {255, 0, 255}});
  EXPECT_EQ(load_image(folder / "png.exr").find("R")->values[0], 1);
}

TEST(AnyImage, SixteenBitPngKeepsItsDigits) {
  const Folder folder;
  put_bytes(folder / "a.png", png(1, 16, 0, "\x12\x34"));
  const double encoded = 0x1234 / 65535.0;  // 0.0711: above the linear foot
  EXPECT_NEAR(load_image(folder / "a.png").find("G")->values[0], std::pow((encoded + 0.055) / 1.055, 2.4), 1e-8);
  // A gAMA chunk of 1 says the samples are linear.
  put_bytes(folder / "a.png", png(1, 16, 0, "\x12\x34", png_chunk("gAMA", big_endian(100000))));
  const Image image = load_image(folder / "a.png");
  EXPECT_FLOAT_EQ(image.find("G")->values[0], float(encoded));
  EXPECT_NE(image.text.at("tempolux:source").find("linear to linear"), std::string::npos);
}

TEST(AnyImage, PngAlphaIsPremultipliedAndPalettesAreExpanded) {
  const Folder folder;
  put_bytes(folder / "a.png", png(1, 8, 6, "\xff\x80\x00\x33" + std::string()));
  EXPECT_NE(message_of<InputError>([&] { load_image(folder / "a.png"); }),
            "");  // the literal ended at its zero byte
  put_bytes(folder / "a.png", png(1, 8, 6, std::string("\xff\x00\x00\x33", 4)));
  const Image image = load_image(folder / "a.png");
  EXPECT_FLOAT_EQ(image.find("A")->values[0], 0.2f);
  EXPECT_FLOAT_EQ(image.find("R")->values[0], 0.2f);
  put_bytes(folder / "b.png", png(8, 1, 3, "\x80", png_chunk("PLTE", std::string("\0\0\0\xff\xff\xff", 6))));
  EXPECT_EQ(load_image(folder / "b.png").find("B")->values, (std::vector<float>{1, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(AnyImage, DamagedPngIsOneLineNeverACrash) {
  const Folder folder;
  const std::string whole = png(3, 8, 2, "123456789"), path = folder / "a.png";
  for (std::size_t size = 0; size + 12 < whole.size(); ++size) {  // IEND itself may be missing
    put_bytes(path, whole.substr(0, size));
    const std::string message = message_of<InputError>([&] { load_image(path); });
    EXPECT_TRUE(message.starts_with(path + ": ")) << size << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] ^= 0x11;
    put_bytes(path, bytes);
    message_of<InputError>([&] { load_image(path); });
  }
  put_bytes(path, "\x89PNG\r\n\x1a\n" +
                      png_chunk("IHDR", big_endian(60000) + big_endian(8000) + "\x10\x06" + std::string(3, '\0')) +
                      png_chunk("IDAT", "x"));
  EXPECT_NE(message_of<InputError>([&] { load_image(path); }).find("more pixels than its bytes"), std::string::npos);
}

TEST(AnyImage, UnknownFormatsAreRefusedByName) {
  const Folder folder;
  for (const std::string& bytes :
       {std::string(), std::string("GIF89a"), std::string("8BPS\0\1", 6), std::string(100, 'x')}) {
    put_bytes(folder / "a.hdr", bytes);
    const std::string message = message_of<InputError>([&] { load_image(folder / "a.hdr"); });
    EXPECT_NE(message.find("not an image we read"), std::string::npos) << message;
  }
}

// What a missing or broken program does: ChildProcess.SaysWhatIsMissing.
TEST(AnyImage, WithoutTheProgramTheMessageSaysWhatToDo) {
  if (helper_is_there()) GTEST_SKIP() << "built with tempolux-oiio";
  const Folder folder;
  put_bytes(folder / "a.hdr", "\xff\xd8\xff\xe0 nothing");
  const std::string message = message_of<InputError>([&] { load_image(folder / "a.hdr"); });
  EXPECT_NE(message.find("a.hdr: reading jpeg needs tempolux-oiio, which was not built or not installed"),
            std::string::npos)
      << message;
}

TEST(AnyImage, TheHelperKeepsTheLimitsAndReportsDamage) {
  if (!helper_is_there()) GTEST_SKIP() << "built without tempolux-oiio";
  const Folder folder;
  const auto message = [&](const std::string& bytes, std::uint64_t max_pixels) {
    put_bytes(folder / "a.img", bytes);
    const std::string text = message_of<InputError>([&] { load_image(folder / "a.img", max_pixels); });
    EXPECT_TRUE(text.starts_with(folder / "a.img: ")) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_LT(text.size(), 1300u);
    return text;
  };
  EXPECT_NE(message("\xff\xd8\xff\xe0 nothing", 100), "");
  EXPECT_NE(message(std::string("II*\0\x08\0\0\0\xff\xff", 10), 100), "");
}

TEST(AnyImage, TheHelperReadsGreyTiffAsSrgb) {
  if (!helper_is_there()) GTEST_SKIP() << "built without tempolux-oiio";
  const Folder folder;
  // A TIFF of 2 x 1 grey bytes: width, height, bits, no compression, black is zero, offset, rows, bytes.
  std::string directory = raw(std::uint16_t(8));
  const auto entry = [&](int tag, int value) {
    directory += raw(std::uint16_t(tag)) + raw(std::uint16_t(4)) + raw(1) + raw(value);
  };
  entry(256, 2), entry(257, 1), entry(258, 8), entry(259, 1), entry(262, 1), entry(273, 8), entry(278, 1),
      entry(279, 2);
  put_bytes(folder / "a.tif", std::string("II*\0", 4) + raw(10) + "\xff\x80" + directory + raw(0));
  const Image image = load_image(folder / "a.tif");
  EXPECT_EQ(image.find("R")->values[0], 1);
  EXPECT_NEAR(image.find("B")->values[1], std::pow((128 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);  // 0.2159
}

}  // namespace
}  // namespace tempolux
