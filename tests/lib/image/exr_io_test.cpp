// EXR: written files are read back to the bit; images that must not be written are refused with their place.
#include "lib/image/exr_io.h"

#include <xmmintrin.h>

#include <bit>
#include <cmath>
#include <limits>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

/// Channels of every kind with random bits that are finite floats; channels sorted, as files have them.
Image random_image(int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  const PathRandom random(1, 2);
  std::uint32_t extra = 0;
  for (const char* name : {"A", "B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "direct.B", "direct.G", "direct.R"})
    for (float& value : image.add(name).values) do
        value = std::bit_cast<float>(std::uint32_t(random.bits(0, Purpose::test, extra++)));
      while (!std::isfinite(value));
  for (std::uint32_t& id : image.add_ids("id.object").ids) id = std::uint32_t(random.bits(0, Purpose::test, extra++));
  image.find("Z")->values[0] = INFINITY;
  image.find("R")->values[0] = -0.0f;
  image.find("G")->values[0] = std::numeric_limits<float>::denorm_min();
  return image;
}

bool same_bits(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && digest_of(a) == digest_of(b);
}

TEST(Exr, FloatsAndIdsComeBackToTheBit) {
  const Folder folder;
  const Image image = random_image(67, 131);  // no multiple of a chunk or slab
  for (const bool zip : {false, true}) {
    save_exr(folder / "a.exr", image, {.zip = zip});
    const Image back = load_exr(folder / "a.exr");
    ASSERT_EQ(back.channels.size(), image.channels.size());
    for (std::size_t c = 0; c < image.channels.size(); ++c) {
      EXPECT_EQ(back.channels[c].name, image.channels[c].name);
      EXPECT_EQ(back.channels[c].ids, image.channels[c].ids);
      ASSERT_EQ(back.channels[c].values.size(), image.channels[c].values.size());
      if (!image.channels[c].values.empty()) {
        EXPECT_EQ(std::memcmp(back.channels[c].values.data(), image.channels[c].values.data(), 4 * image.pixel_count()),
                  0)
            << image.channels[c].name;
      }
    }
    EXPECT_TRUE(std::signbit(back.find("R")->values[0]));
  }
}

TEST(Exr, ColourAloneIsRead) {
  const Folder folder;
  Image image = random_image(67, 131);
  save_exr(folder / "a.exr", image);
  const Image back = load_exr(folder / "a.exr", {.only_rgb = true});
  ASSERT_EQ(back.channels.size(), 3u);
  for (const char* name : {"B", "G", "R"}) {
    ASSERT_NE(back.find(name), nullptr);
    EXPECT_EQ(std::memcmp(back.find(name)->values.data(), image.find(name)->values.data(), 4 * image.pixel_count()), 0)
        << name;
  }
  // Without one of them there is no colour: all is read.
  std::erase_if(image.channels, [](const Channel& channel) { return channel.name == "G"; });
  save_exr(folder / "b.exr", image);
  EXPECT_EQ(load_exr(folder / "b.exr", {.only_rgb = true}).channels.size(), image.channels.size());
}

TEST(Exr, DenormalsComeBackUnderFlushToZero) {
  const Folder folder;
  const Image image = random_image(5, 4);
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040);  // as every tool runs
  save_exr(folder / "a.exr", image);
  const Image back = load_exr(folder / "a.exr");
  _mm_setcsr(before);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(back.find("G")->values[0]), 1u);
  EXPECT_TRUE(same_bits(image, back));
}

TEST(Exr, AttributesComeBack) {
  const Folder folder;
  Image image = random_image(3, 2);
  image.text["tempolux:history"] = "0.1.0 frame-render --spp 4\n";
  image.text["an attribute name of more than thirty-one bytes"] = "";
  image.numbers["tempolux:frame"] = 1.0 / 3;
  image.numbers["framesPerSecond"] = 24;
  image.matrices["worldToCamera"] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 0.5};
  image.matrices["tempolux:other"] = {1.0 / 3};
  save_exr(folder / "a.exr", image);
  const Image back = load_exr(folder / "a.exr");
  EXPECT_EQ(back.text, image.text);
  EXPECT_EQ(back.numbers, image.numbers);
  EXPECT_EQ(back.matrices, image.matrices);
  image.numbers = {{"framesPerSecond", 23.976}};
  save_exr(folder / "a.exr", image);
  EXPECT_EQ(load_exr(folder / "a.exr").numbers["framesPerSecond"], 24000.0 / 1001);
}

TEST(Exr, EqualImagesGiveEqualFilesForAnyNumberOfThreads) {
  const Folder folder;
  const Image image = random_image(40, 400);
  std::string first;
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    save_exr(folder / "a.exr", image);
    if (first.empty()) first = bytes_of(folder / "a.exr");
    EXPECT_EQ(bytes_of(folder / "a.exr"), first) << threads;
    EXPECT_TRUE(same_bits(load_exr(folder / "a.exr"), image)) << threads;
  }
  Image turned = image;  // the order of adding is not in the file
  std::reverse(turned.channels.begin(), turned.channels.end());
  save_exr(folder / "b.exr", turned);
  EXPECT_EQ(bytes_of(folder / "b.exr"), first);
}

TEST(Exr, HalvesRoundToNearestEvenAndOnlyColourIsHalved) {
  const Folder folder;
  Image image;
  image.width = 4;
  image.height = 1;
  // float16 has 10 bits of fraction: 1 + 2^-11 lies midway between 1 and 1 + 2^-10, 1 + 3*2^-11 midway to 1 +
  // 2^-9.
  const std::vector<float> values{1 + 0x1p-11f, 1 + 0x3p-11f, 65504, -65504};
  for (const char* name : {"R", "indirect.G", "A", "Z", "N.X", "P.Z", "forward.u", "mask"})
    image.add(name).values = values;
  save_exr(folder / "a.exr", image, {true});
  const Image back = load_exr(folder / "a.exr");
  for (const char* name : {"R", "indirect.G", "A"})
    EXPECT_EQ(back.find(name)->values, (std::vector<float>{1, 1 + 0x1p-9f, 65504, -65504})) << name;
  for (const char* name : {"Z", "N.X", "P.Z", "forward.u", "mask"}) EXPECT_EQ(back.find(name)->values, values) << name;
}

TEST(Exr, ValuesAboveHalfAreRefusedWithTheirPlace) {
  const Folder folder;
  Image image = random_image(3, 2);
  for (Channel& channel : image.channels) std::fill(channel.values.begin(), channel.values.end(), 1.0f);
  image.find("Z")->values[1] = 1e9f;  // not colour
  save_exr(folder / "ok.exr", image, {true});
  image.find("direct.G")->values[4] = std::nextafter(65504.0f, 1e9f);
  const std::string message = message_of<InputError>([&] { save_exr(folder / "a.exr", image, {true}); });
  EXPECT_NE(message.find("a.exr: channel direct.G: pixel (1, 1): 65504.00"), std::string::npos) << message;
  EXPECT_NE(message.find("--half"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.exr"));
  EXPECT_NO_THROW(save_exr(folder / "a.exr", image));
}

TEST(Exr, NotANumberIsNeitherWrittenNorRead) {
  const Folder folder;
  Image image = random_image(3, 2);
  save_exr(folder / "ok.exr", image, {.zip = false});
  for (const char* name : {"R", "N.Y", "Z"}) {
    Image bad = image;
    bad.find(name)->values[5] = NAN;
    const std::string message = message_of<InputError>([&] { save_exr(folder / "a.exr", bad); });
    EXPECT_NE(message.find("channel " + std::string(name) + ": pixel (2, 1): not a number"), std::string::npos)
        << message;
  }
  for (const char* name : {"R", "N.Z"}) {
    Image bad = image;
    bad.find(name)->values[3] = -INFINITY;
    const std::string message = message_of<InputError>([&] { save_exr(folder / "a.exr", bad); });
    EXPECT_NE(message.find("channel " + std::string(name) + ": pixel (0, 1): infinite"), std::string::npos) << message;
  }
  image.find("Z")->values[0] = -INFINITY;
  EXPECT_THROW(save_exr(folder / "a.exr", image), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.exr"));

  // A file of another program: one pixel of R whose four bytes are NaN.
  const std::string head =
      exr::magic() + exr::header(exr::channel("R", 2), exr::box(0, 0, 0, 0), exr::box(0, 0, 0, 0)) + '\0';
  put_bytes(folder / "nan.exr", head + raw(std::uint64_t(head.size() + 8)) + raw(0) + raw(4) + raw(std::nanf("")));
  const std::string message = message_of<InputError>([&] { load_exr(folder / "nan.exr"); });
  EXPECT_NE(message.find("nan.exr: channel R: pixel (0, 0): not a number"), std::string::npos) << message;
  EXPECT_TRUE(std::isnan(load_exr(folder / "nan.exr", {1, true}).find("R")->values[0]));
}

TEST(Exr, DataWindowIsPlacedIntoTheDisplayWindow) {
  const Folder folder;
  // Display 3 x 2 at (10, 20); data 3 x 2 at (9, 21): its left column and lower line fall outside.
  const std::string head =
      exr::magic() +
      exr::header(exr::channel("Y", 2) + exr::channel("Z", 2) + exr::channel("id", 0) + exr::channel("id.object", 0),
                  exr::box(9, 21, 11, 22), exr::box(10, 20, 12, 21)) +
      '\0';
  std::string table, chunks;
  for (int line = 0; line < 2; ++line) {
    table += raw(std::uint64_t(head.size() + 16 + chunks.size()));
    chunks += raw(21 + line) + raw(48);
    for (int twice = 0; twice < 2; ++twice)
      for (int x = 0; x < 3; ++x) chunks += raw(float(10 * line + x + 1));
    for (int twice = 0; twice < 2; ++twice)
      for (int x = 0; x < 3; ++x) chunks += raw(std::uint32_t(10 * line + x + 1));
  }
  put_bytes(folder / "a.exr", head + table + chunks);
  const Image image = load_exr(folder / "a.exr");
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 2);
  EXPECT_EQ(image.find("Y")->values, (std::vector<float>{0, 0, 0, 2, 3, 0}));
  EXPECT_EQ(image.find("id")->ids, (std::vector<std::uint32_t>{0, 0, 0, 2, 3, 0}));
  // Parts of the display window outside the data window show nothing.
  EXPECT_EQ(image.find("Z")->values, (std::vector<float>{INFINITY, INFINITY, INFINITY, 2, 3, INFINITY}));
  constexpr std::uint32_t none = 0xffffffff;
  EXPECT_EQ(image.find("id.object")->ids, (std::vector<std::uint32_t>{none, none, none, 2, 3, none}));
}

/// Lines without compression are copied directly, also past channels of halves. OpenEXR reads the file if a line has
/// another number than expected, or if channels of halves are wanted.
TEST(Exr, LinesWithoutCompressionAreFoundByTheTable) {
  const Folder folder;
  const std::string head = exr::magic() +
                           exr::header(exr::channel("H", 1) + exr::channel("Y", 2) + exr::channel("id", 0),
                                       exr::box(0, 0, 1, 1), exr::box(0, 0, 1, 1)) +
                           '\0';
  const auto line = [](int y) {  // two pixels: 0x3c00 is 1, 0x4000 is 2
    return raw(y) + raw(std::int32_t(20)) + raw(std::uint16_t(0x3c00)) + raw(std::uint16_t(0x4000)) +
           raw(float(10 * y + 1)) + raw(float(10 * y + 2)) + raw(7u) + raw(std::uint32_t(8 + y));
  };
  const std::uint64_t first = head.size() + 16, second = first + line(0).size();
  put_bytes(folder / "a.exr", head + raw(first) + raw(second) + line(0) + line(1));
  for (const bool halves : {false, true}) {
    const Image image =
        load_exr(folder / "a.exr", {.wanted = [&](const std::string& name) { return halves || name != "H"; }});
    EXPECT_EQ(image.channels.size(), halves ? 3u : 2u);
    EXPECT_EQ(image.find("Y")->values, (std::vector<float>{1, 2, 11, 12}));
    EXPECT_EQ(image.find("id")->ids, (std::vector<std::uint32_t>{7, 8, 7, 9}));
    if (halves) { EXPECT_EQ(image.find("H")->values, (std::vector<float>{1, 2, 1, 2})); }
  }
  put_bytes(folder / "b.exr",
            head + raw(second) + raw(first) + line(0) + line(1));  // each entry leads to the other line
  EXPECT_THROW(load_exr(folder / "b.exr", {.wanted = [](const std::string& name) { return name == "Y"; }}), InputError);
}

TEST(Exr, TilesAreRead) {
  const Folder folder;
  // 3 x 2 pixels in tiles of 2 x 2, half: the second tile is one column wide. 0x3c00 is 1, 0x4000 is 2,
  // 0x4400 is 4.
  const std::string head = exr::magic(0x200) +
                           exr::header(exr::channel("R", 1), exr::box(0, 0, 2, 1), exr::box(0, 0, 2, 1)) +
                           exr::attribute("tiles", "tiledesc", raw(2u) + raw(2u) + '\0') + '\0';
  const auto tile = [](int x, std::vector<std::uint16_t> samples) {
    std::string bytes = raw(x) + raw(0) + raw(0) + raw(0) + raw(std::int32_t(2 * samples.size()));
    for (auto sample : samples) bytes += raw(sample);
    return bytes;
  };
  const std::string first = tile(0, {0x3c00, 0x4000, 0x4400, 0}), second = tile(1, {0x4000, 0x3c00});
  put_bytes(folder / "a.exr", head + raw(std::uint64_t(head.size() + 16)) +
                                  raw(std::uint64_t(head.size() + 16 + first.size())) + first + second);
  EXPECT_EQ(load_exr(folder / "a.exr").find("R")->values, (std::vector<float>{1, 2, 2, 4, 0, 1}));
}

TEST(Exr, OfAMultiPartFileTheFirstPartIsRead) {
  const Folder folder;
  std::string head = exr::magic(0x1000);
  for (const char* name : {"one", "two"})
    head += exr::header(exr::channel("R", 2), exr::box(0, 0, 0, 0), exr::box(0, 0, 0, 0)) +
            exr::attribute("chunkCount", "int", raw(1)) + exr::attribute("name", "string", name) +
            exr::attribute("type", "string", "scanlineimage") + '\0';
  head += '\0';
  const auto chunk = [](int part, float value) { return raw(part) + raw(0) + raw(4) + raw(value); };
  put_bytes(folder / "a.exr", head + raw(std::uint64_t(head.size() + 16)) + raw(std::uint64_t(head.size() + 32)) +
                                  chunk(0, 5) + chunk(1, 6));
  EXPECT_EQ(load_exr(folder / "a.exr").find("R")->values, std::vector<float>{5});
}

TEST(Exr, DigestIsOfSizeNamesAndSamplesOnly) {
  const Folder folder;
  Image image = random_image(8, 4);
  const std::string digest = digest_of(image);
  EXPECT_EQ(digest.size(), 32u);
  save_exr(folder / "none.exr", image, {.zip = false});
  image.text["tempolux:history"] = "x";
  image.numbers["tempolux:frame"] = 3;
  save_exr(folder / "zip.exr", image);
  EXPECT_EQ(digest_of(load_exr(folder / "none.exr")), digest);
  EXPECT_EQ(digest_of(load_exr(folder / "zip.exr")), digest);

  Image other = image;
  std::reverse(other.channels.begin(), other.channels.end());
  EXPECT_EQ(digest_of(other), digest);
  other = image;
  other.find("R")->values[3] = -other.find("R")->values[3];
  EXPECT_NE(digest_of(other), digest);
  other = image;
  other.find("R")->name = "S";
  EXPECT_NE(digest_of(other), digest);
  other = image;
  std::swap(other.width, other.height);
  EXPECT_NE(digest_of(other), digest);
  other = image;
  Channel& id = *other.find("id.object");
  for (std::uint32_t bits : id.ids) id.values.push_back(std::bit_cast<float>(bits));
  id.ids.clear();
  EXPECT_NE(digest_of(other), digest);
}

TEST(Exr, WhatCannotBeWrittenIsAResourceErrorAndMistakesAreTheCallers) {
  const Folder folder;
  Image image = random_image(64, 64);
  const std::string full = message_of<ResourceError>([&] { save_exr("/dev/full", image); });
  EXPECT_NE(full.find("No space left"), std::string::npos) << full;
  EXPECT_THROW(save_exr(folder / "none/a.exr", image), ResourceError);
  image.numbers["tempolux:frame"] = NAN;
  EXPECT_THROW(save_exr(folder / "a.exr", image), InputError);
  image.numbers.clear();
  image.add("R");
  EXPECT_THROW(save_exr(folder / "a.exr", image), std::invalid_argument);
  image.channels.back().name = "short";
  image.channels.back().values.pop_back();
  EXPECT_THROW(save_exr(folder / "a.exr", image), std::invalid_argument);
  EXPECT_THROW(load_exr(folder / "absent.exr"), InputError);
  EXPECT_THROW(load_exr(folder / "."), InputError);
}

TEST(Image, LayersAreThoseWithAllThreeComponents) {
  Image image = random_image(2, 1);
  image.add("half.R");
  EXPECT_EQ(image.layers(), (std::vector<std::string>{"", "direct"}));
  EXPECT_EQ(image.rgb("direct")[1], &image.find("direct.G")->values);
  EXPECT_EQ(image.rgb("")[0], &image.find("R")->values);
  const std::string message = message_of<InputError>([&] { image.rgb("half"); });
  EXPECT_NE(message.find("RGB, direct"), std::string::npos) << message;
}

TEST(Exr, CyclesReferencesLoad) {
  const std::string folder = "../../shared/scenes/ref/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder << " beside the project";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".exr") continue;
    const Image image = load_exr(entry.path());
    EXPECT_EQ(image.width, 320);
    EXPECT_EQ(image.height, 180);
    double sum = 0;
    for (const auto* plane : image.rgb(""))
      for (float value : *plane) sum += double(value);
    std::printf("%s: mean %.6f\n", entry.path().filename().c_str(), sum / (3 * double(image.pixel_count())));
    EXPECT_GT(sum, 0);
  }
}

}  // namespace
}  // namespace tempolux
