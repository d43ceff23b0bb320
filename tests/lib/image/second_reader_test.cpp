// The page formats/frames/frames.md, its worked example, and a second reader written from it in Python.
#include <array>
#include <cmath>
#include <cstdio>

#include "lib/core/random.h"
#include "lib/image/exr_io.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  for (std::size_t got; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) text.append(buffer.data(), got);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}

const std::string kReader = "PYTHONDONTWRITEBYTECODE=1 python3 lib/image/read_frame.py ";

/// The frame of the worked example: 2 x 2 pixels; above a red lamp on a wall and the wall, below the wall and nothing.
Image example() {
  Image image;
  image.width = image.height = 2;
  image.add("R").values = {4.5f, 0.125f, 0.0625f, 0};
  image.add("G").values = {0.5f, 0.125f, 0.0625f, 0};
  image.add("B").values = {0.25f, 0.125f, 0.0625f, 0};
  image.add("A").values = {1, 1, 1, 0};
  image.add("Z").values = {3, 3.25f, 2.75f, INFINITY};
  image.add("backward.u").values = {0, -1.5f, 0, 0};
  image.add("backward.v").values = {0, 0.5f, 0, 0};
  image.add_ids("id.object").ids = {7, 2, 2, 0xffffffffu};
  image.text["tempolux:history"] = "0.1.0 frame-render wall.glb --frame 12 --size 2x2\n";
  image.numbers["tempolux:frame"] = 12;
  image.numbers["framesPerSecond"] = 24;
  return image;
}

TEST(FramesPage, TheWorkedExampleIsWhatWeWriteAndWhatThePageSays) {
  const Image image = example();
  const Folder folder;
  save_exr(folder / "a.exr", image, {.zip = false});
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of("lib/image/example.exr"));
  const std::string page = bytes_of("../formats/frames/frames.md");
  std::string printed = output_of(kReader + "lib/image/example.exr 1 0"), indented;
  for (std::size_t at = 0, end; (end = printed.find('\n', at)) != std::string::npos; at = end + 1)
    indented += "    " + printed.substr(at, end - at + 1);
  EXPECT_NE(page.find(indented), std::string::npos) << "the page lacks:\n" << indented;
  EXPECT_NE(page.find(digest_of(image)), std::string::npos) << "the page lacks the digest " << digest_of(image);
}

TEST(FramesPage, TheSecondReaderFindsTheSameSamples) {
  const Folder folder;
  Image image;
  image.width = 37;
  image.height = 35;  // the last ZIP chunk has 3 lines
  const PathRandom random(7, 8);
  for (const char* name : {"R", "G", "B", "indirect.R", "Z"}) {
    auto& values = image.add(name).values;
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::floor(16 * random.get1(std::uint32_t(i / 9), Purpose::test)) / 16;
  }
  auto& ids = image.add_ids("id.object").ids;
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = std::uint32_t(i / 50);
  for (const auto& options : {ExrWriteOptions{.zip = false}, ExrWriteOptions{}, ExrWriteOptions{.half = true}}) {
    save_exr(folder / "a.exr", image, options);
    for (auto [x, y] : {std::pair{0, 0}, std::pair{36, 15}, std::pair{5, 16}, std::pair{36, 34}}) {
      std::string expected;
      const std::size_t at = std::size_t(y * image.width + x);
      for (const char* name : {"B", "G", "R", "Z", "id.object", "indirect.R"}) {  // order of the names
        const Channel& channel = *image.find(name);
        char line[64];
        if (channel.ids.empty()) std::snprintf(line, sizeof line, "%s %.9g\n", name, double(channel.values[at]));
        else std::snprintf(line, sizeof line, "%s %u\n", name, channel.ids[at]);
        expected += line;
      }
      EXPECT_EQ(output_of(kReader + (folder / "a.exr") + " " + std::to_string(x) + " " + std::to_string(y)), expected);
    }
  }
}

}  // namespace
}  // namespace tempolux
