// The module returns what its decoders return: pixels, messages, kinds of errors.
#include "lib/image/images_by_module.h"

#include "formats/error.h"
#include "lib/image/any_io.h"
#include "lib/image/exr_io.h"
#include "tests/lib/image/image_fixture.h"
#include "tests/support/png_bytes.h"

namespace tempolux {
namespace {

TEST(ImagesByModule, TexturesAreDecodedAsDecodeImageDoes) {
  for (int channels = 1; channels <= 4; ++channels) {
    std::vector<std::uint8_t> codes;
    for (int i = 0; i < 6 * channels; ++i) codes.push_back(std::uint8_t(10 * i));
    const CodedPixels pixels = decode_by_module(test::png_image(3, 2, channels, codes), 1 << 20);
    EXPECT_EQ(pixels.width, 3);
    EXPECT_EQ(pixels.height, 2);
    EXPECT_EQ(pixels.channels, channels);
    EXPECT_EQ(pixels.bits, 8);
    EXPECT_EQ(pixels.bytes, codes);
  }
}

TEST(ImagesByModule, ErrorsComeBackWhole) {
  EncodedImage image = test::png_image(3, 2, 3, std::vector<std::uint8_t>(18));
  image.place = std::string(3000, 'p') + ".png";  // longer than any buffer of a fixed size
  const std::string too_large = message_of<InputError>([&] { decode_image(image, 5); });
  EXPECT_TRUE(too_large.starts_with(image.place + ": ")) << too_large;
  EXPECT_EQ(message_of<InputError>([&] { decode_by_module(image, 5); }), too_large);
  image.bytes.resize(image.bytes.size() / 2);
  EXPECT_EQ(message_of<InputError>([&] { decode_by_module(image, 100); }),
            message_of<InputError>([&] { decode_image(image, 100); }));
  const Folder folder;
  EXPECT_EQ(message_of<InputError>([&] { load_by_module(folder / "none.exr", 100); }),
            message_of<InputError>([&] { load_image(folder / "none.exr"); }));
}

TEST(ImagesByModule, ColourIsThatOfTheChannels) {
  const Folder folder;
  Image image;
  image.width = 2, image.height = 1;
  image.add("B").values = {0.25f, 5};
  image.add("R").values = {0.5f, -1};
  image.add("Z").values = {9, 9};
  save_exr(folder / "two.exr", image);
  EXPECT_TRUE(message_of<InputError>([&] {
                load_by_module(folder / "two.exr", 100);
              }).starts_with(folder / "two.exr: no colour layer"));  // no G
  image.add("G").values = {1e10f, 3};
  save_exr(folder / "three.exr", image);
  const LinearPixels read = load_by_module(folder / "three.exr", 100);
  EXPECT_EQ(read.width, 2);
  EXPECT_EQ(read.height, 1);
  ASSERT_EQ(read.pixels.size(), 2u);
  EXPECT_EQ(read.pixels[0], Rgb(0.5f, 1e10f, 0.25f));
  EXPECT_EQ(read.pixels[1], Rgb(-1, 3, 5));
}

}  // namespace
}  // namespace tempolux
