// Pixel flow and masks as images: the pages formats/flow/flow.md and formats/mask/mask.md.
#include <filesystem>

#include "formats/error.h"
#include "lib/image/exr_io.h"
#include "lib/image/pixel_flow.h"
#include "lib/image/why_mask.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

const std::string kFormats = "formats/";

/// The attributes of the pages' examples.
void describe(Image& image) {
  image.text["tempolux:history"] = "0.1.0 ibr-warp 8.exr 16.exr --scene wall.glb --frame 12\n";
  image.numbers["tempolux:frame"] = 12;
  image.numbers["framesPerSecond"] = 24;
}

Image image_of(int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  describe(image);
  return image;
}

std::string written(const Image& image) {
  const Folder folder;
  save_exr(folder / "a.exr", image, {.zip = false});
  return bytes_of(folder / "a.exr");
}

TEST(FlowPage, TheWorkedExampleIsWhatWeWrite) {
  PixelFlow flow(2, 2);
  flow.forward = {{1.5f, 0.5f}, {1.5f, 0.5f}, {}, {}};
  flow.backward = {{-1.5f, -0.5f}, {}, {}, {}};
  flow.valid = {3, 1, 3, 0};
  flow.speed = {12, 12, 0, 0};
  Image image = image_of(2, 2);
  add_flow_channels(flow, image);
  const std::string file = kFormats + "flow/accept/worked-example.exr";
  EXPECT_EQ(written(image), bytes_of(file));
  const PixelFlow read = flow_in(load_exr(file), file);
  EXPECT_EQ(read.forward, flow.forward);
  EXPECT_EQ(read.backward, flow.backward);
  EXPECT_EQ(read.valid, flow.valid);
  EXPECT_EQ(read.speed, flow.speed);
}

TEST(MaskPage, TheWorkedExampleIsWhatWeWrite) {
  Image image = image_of(4, 1);
  image.add_ids("why").ids = {0, formats::why_specular, formats::why_occlusion | formats::why_edge,
                              formats::why_border};
  EXPECT_EQ(written(image), bytes_of(kFormats + "mask/accept/worked-example.exr"));
}

/// Every file of a folder is read, or refused with a line that begins with its name.
template <class Read>
int expect_files(const std::string& folder, bool good, const Read& read) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string path = entry.path().string();
    ++count;
    try {
      read(load_exr(path), path);
      EXPECT_TRUE(good) << path << " was read";
    } catch (const InputError& error) {
      EXPECT_FALSE(good) << error.what();
      EXPECT_EQ(std::string(error.what()).find(path), 0u) << error.what();
    }
  }
  return count;
}

TEST(FlowPage, AcceptAndRefuse) {
  const auto read = [](const Image& image, const std::string& path) { flow_in(image, path); };
  EXPECT_GE(expect_files(kFormats + "flow/accept", true, read), 5);
  EXPECT_GE(expect_files(kFormats + "flow/refuse", false, read), 13);
}

TEST(MaskPage, AcceptAndRefuse) {
  const auto read = [](const Image& image, const std::string& path) { whys_in(image, path); };
  EXPECT_GE(expect_files(kFormats + "mask/accept", true, read), 5);
  EXPECT_GE(expect_files(kFormats + "mask/refuse", false, read), 3);
}

TEST(MaskPage, EveryPixelIsCountedOnceUnderItsFirstCause) {
  using namespace formats;
  const auto counts = count_whys({0, why_edge | why_specular, why_edge, 1u << 20, why_slow | 1u << 20});
  ASSERT_EQ(counts.size(), kWhys.size() + 1);
  std::uint64_t sum = 0;
  for (const WhyCount& count : counts) sum += count.first;
  EXPECT_EQ(sum, 4u);
  EXPECT_EQ(counts[0].first, 1u);   // specular
  EXPECT_EQ(counts[6].pixels, 2u);  // edge
  EXPECT_EQ(counts[6].first, 1u);
  EXPECT_EQ(counts.back().name, "unknown");
  EXPECT_EQ(counts.back().pixels, 2u);
  EXPECT_EQ(counts.back().first, 1u);
}

TEST(MaskPage, TheBitsAreThoseOfThePage) {
  const std::string page = bytes_of("../formats/mask/mask.md");
  for (const auto& [bit, name, color] : formats::kWhys) {
    std::string number = std::to_string(int(bit));
    EXPECT_NE(page.find("| " + number + " | " + std::string(name) + " |"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace tempolux
