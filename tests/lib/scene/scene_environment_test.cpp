// Environments: what is read, mended and refused; what counts in their hash.
#include "lib/scene/environment.h"

#include <cmath>
#include <limits>

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

Image picture(int width, int height, float value) {
  Image image;
  image.width = width;
  image.height = height;
  for (const char* name : {"R", "G", "B"})
    image.add(name).values.assign(std::size_t(width) * std::size_t(height), value);
  return image;
}

/// Two rows: (1, 0.5, 0.25) above (8, 8, 8).
std::string tiny_hdr() {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 1\n" + std::string("\x80\x40\x20\x81\x80\x80\x80\x84", 8);
}

TEST(EnvironmentFile, RadianceAndOpenExrTimesStrength) {
  const Folder folder;
  put_bytes(folder / "a.hdr", tiny_hdr());
  const Environment hdr = load_environment(folder / "a.hdr", {2, 0});
  EXPECT_EQ(hdr.width, 1);
  EXPECT_EQ(hdr.height, 2);
  EXPECT_EQ(hdr.radiance, (std::vector<Rgb>{{2, 1, 0.5f}, Rgb(16.0f)}));
  save_exr(folder / "a.exr", picture(4, 2, 0.5f));
  EXPECT_EQ(load_environment(folder / "a.exr", {1e-20, 0}).radiance[7].g, 0.5e-20f);
  EXPECT_EQ(load_environment(folder / "a.exr", {1e20, 0}).radiance[7].g, 0.5e20f);
  EXPECT_FALSE(load_environment(folder / "a.exr", {0, 0}).emits());
}

TEST(EnvironmentFile, NegativeValuesBecomeZeroWithOneWarning) {
  const Folder folder;
  Image image = picture(4, 2, 1);
  image.find("G")->values[5] = -3;
  image.find("B")->values[6] = -0.5f;
  save_exr(folder / "a.exr", image);
  const Environment environment = load_environment(folder / "a.exr", {});
  EXPECT_EQ(environment.radiance[5], Rgb(1, 0, 1));
  ASSERT_EQ(environment.warnings.size(), 1u);
  EXPECT_NE(environment.warnings[0].find("2 negative values, the first at pixel (1, 1)"), std::string::npos);
}

TEST(EnvironmentFile, NotANumberInfinityAndTooMuchAreRefusedByPixel) {
  const Folder folder;
  const auto message = [&](float value, const EnvironmentOptions& options) {
    // save_exr refuses such values, so the bytes of a recognisable one are exchanged.
    Image image = picture(4, 2, 1);
    image.find("R")->values[6] = 1234.5f;
    save_exr(folder / "a.exr", image, {.zip = false});
    std::string bytes = bytes_of(folder / "a.exr");
    const std::size_t at = bytes.find(raw(1234.5f));
    EXPECT_NE(at, std::string::npos);
    put_bytes(folder / "a.exr", bytes.replace(at, 4, raw(value)));
    return message_of<InputError>([&] { load_environment(folder / "a.exr", options); });
  };
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), INFINITY, -INFINITY}) {
    const std::string text = message(value, {});
    EXPECT_NE(text.find("a.exr: "), std::string::npos);
    EXPECT_NE(text.find("(2, 1)"), std::string::npos) << text;
  }
  EXPECT_NE(message(1e20f, {1e20, 0}).find("pixel (2, 1): its radiance is beyond 1e30"), std::string::npos);
  EXPECT_EQ(message(1e20f, {}), "");
}

TEST(EnvironmentFile, WithoutColoursOrTooLargeIsRefused) {
  const Folder folder;
  Image grey;
  grey.width = grey.height = 1;
  grey.add("Z").values = {1};
  save_exr(folder / "a.exr", grey);
  EXPECT_THROW(load_environment(folder / "a.exr", {}), InputError);
  save_exr(folder / "b.exr", picture(4, 2, 1));
  EXPECT_THROW(load_environment(folder / "b.exr", {1, 0, 7}), InputError);
  EXPECT_THROW(load_environment(folder / "nowhere.hdr", {}), InputError);
  EXPECT_THROW(uniform_environment(Rgb(1, -1, 1), {}), InputError);
  EXPECT_THROW(uniform_environment(Rgb(1, NAN, 1), {}), InputError);
}

// Content, strength and rotation count; names and whole turns do not.
TEST(EnvironmentHash, IsOfWhatShines) {
  const Folder folder;
  put_bytes(folder / "a.hdr", tiny_hdr());
  put_bytes(folder / "b.hdr", tiny_hdr());
  std::string other = tiny_hdr();
  other.back() = '\x85';
  put_bytes(folder / "c.hdr", other);
  const auto hash = [&](const std::string& file, const EnvironmentOptions& options) {
    return load_environment(folder / file, options).hash;
  };
  EXPECT_EQ(hash("a.hdr", {}), hash("b.hdr", {}));
  EXPECT_EQ(hash("a.hdr", {}), hash("a.hdr", {1, 360}));
  EXPECT_NE(hash("a.hdr", {}), hash("c.hdr", {}));
  EXPECT_NE(hash("a.hdr", {}), hash("a.hdr", {1, 90}));
  EXPECT_NE(hash("a.hdr", {}), hash("a.hdr", {2, 0}));
}

}  // namespace
}  // namespace tempolux
