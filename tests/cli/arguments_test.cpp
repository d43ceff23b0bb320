#include "tools/common/arguments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <set>
#include <string>

#include "formats/error.h"
#include "lib/core/random.h"

namespace tempolux::tools {
namespace {

using Frames = std::vector<int>;

TEST(Frames, AreReadAsWritten) {
  EXPECT_EQ(parse_frames("12"), Frames({12}));
  EXPECT_EQ(parse_frames("0-4"), Frames({0, 1, 2, 3, 4}));
  EXPECT_EQ(parse_frames("0-7x2"), Frames({0, 2, 4, 6}));
  EXPECT_EQ(parse_frames("0-7y2"), Frames({1, 3, 5, 7}));
  EXPECT_EQ(parse_frames("1,5,9"), Frames({1, 5, 9}));
  EXPECT_EQ(parse_frames("9-7"), Frames({9, 8, 7}));
  EXPECT_EQ(parse_frames("9-1x4"), Frames({9, 5, 1}));
  EXPECT_EQ(parse_frames("-5"), Frames({-5}));
  EXPECT_EQ(parse_frames("-5--3"), Frames({-5, -4, -3}));
  EXPECT_EQ(parse_frames("-1-1"), Frames({-1, 0, 1}));
  EXPECT_EQ(parse_frames("3-3"), Frames({3}));
  EXPECT_EQ(parse_frames("0-10x100"), Frames({0}));
}

TEST(Frames, KeepTheirOrderAndDropDuplicates) { EXPECT_EQ(parse_frames("5,1-3,2,5-6"), Frames({5, 1, 2, 3, 6})); }

TEST(Frames, MalformedRangesAreInputErrors) {
  for (const char* text :
       {"",           ",",    "1,",   ",1",         "a",          "1-", "1--",   "1-2x",  "1-2x0",       "1-2x-1",
        "1-2z3",      "1x2",  "1.5",  " 1",         "1 ",         "+1", "1-2-3", "0-5y1", "99999999999", "0-200000000",
        "0-99999999", "1-2,", "\xff", "2147483647", "-2147483648"})
    EXPECT_THROW(parse_frames(text), InputError) << "'" << text << "'";
}

TEST(Frames, AMillionIsTheMost) {
  EXPECT_EQ(parse_frames("0-999999").size(), 1000000u);
  EXPECT_THROW(parse_frames("0-1000000"), InputError);
  EXPECT_THROW(parse_frames("0-999999,1000000"), InputError);
}

// For any A, B, S: xS and yS together are the whole range, have no frame in common, and every frame of xS is
// a multiple of S away from A.
TEST(Frames, EveryNthAndTheOthersMakeTheRange) {
  for (std::uint64_t trial = 0; trial < 500; ++trial) {
    const std::uint64_t bits = PathRandom(1, trial).bits(0, Purpose::test);
    const int a = int(bits % 200) - 100, b = int((bits >> 16) % 200) - 100, s = int((bits >> 32) % 9) + 2;
    const std::string range = std::to_string(a) + "-" + std::to_string(b);
    const Frames all = parse_frames(range), nth = parse_frames(range + "x" + std::to_string(s));
    ASSERT_EQ(all.front(), a);
    ASSERT_EQ(all.back(), b);
    Frames both = nth;
    if (a != b) {
      const Frames others = parse_frames(range + "y" + std::to_string(s));
      both.insert(both.end(), others.begin(), others.end());
    }
    for (const int frame : nth) ASSERT_EQ((frame - a) % s, 0);
    ASSERT_EQ(both.size(), all.size());
    ASSERT_EQ(std::set<int>(both.begin(), both.end()), std::set<int>(all.begin(), all.end()));
  }
}

TEST(FrameNames, ArePutIntoThePattern) {
  EXPECT_EQ(frame_name("f.####.exr", 12), "f.0012.exr");
  EXPECT_EQ(frame_name("f.%04d.exr", 12), "f.0012.exr");
  EXPECT_EQ(frame_name("f.%d.exr", 12), "f.12.exr");
  EXPECT_EQ(frame_name("f.%3d.exr", 12), "f. 12.exr");
  EXPECT_EQ(frame_name("f.#.exr", 12345), "f.12345.exr");
  EXPECT_EQ(frame_name("d##/f##", 7), "d07/f07");
  EXPECT_EQ(frame_name("f.####.exr", -3), "f.-003.exr");
  EXPECT_EQ(frame_name("plain.exr", 12), "plain.exr");
  EXPECT_EQ(frame_name("100%%.exr", 12), "100%.exr");
}

TEST(FrameNames, AnyOtherPerCentSignIsAnInputError) {
  for (const char* text : {"%", "f%s", "f%n", "%04x", "%0", "%123d", "%-4d", "%%%", "%ld"})
    EXPECT_THROW(frame_name(text, 1), InputError) << text;
}

TEST(FrameNames, KnowWhetherTheyHaveAPattern) {
  for (const char* text : {"#", "f.####.exr", "%d", "f%04d", "%%%d"}) EXPECT_TRUE(has_frame_pattern(text)) << text;
  for (const char* text : {"", "f.exr", "%%", "%%d", "100%%"}) EXPECT_FALSE(has_frame_pattern(text)) << text;
}

TEST(Counts, AreDecimal) {
  EXPECT_EQ(parse_count("0"), 0u);
  EXPECT_EQ(parse_count("250000"), 250000u);
  EXPECT_EQ(parse_count("10k"), 10000u);
  EXPECT_EQ(parse_count("10K"), 10000u);
  EXPECT_EQ(parse_count("1.5M"), 1500000u);
  EXPECT_EQ(parse_count("1G"), 1000000000u);
  EXPECT_EQ(parse_count("0.001k"), 1u);
  EXPECT_EQ(parse_count("1.50"
                        "k"),
            1500u);
  EXPECT_EQ(parse_count("2.0"), 2u);
  EXPECT_EQ(parse_count("9223372036854775807"), 9223372036854775807u);
}

TEST(Counts, ThatAreNotWholeOrTooLargeAreInputErrors) {
  for (const char* text : {"",
                           "k",
                           "1.5",
                           "1.0001k",
                           "-1",
                           "+1",
                           "1e6",
                           "1 M",
                           "1m",
                           "1kk",
                           "1Ki",
                           ".5k",
                           "5.",
                           "1.2.3k",
                           "1T",
                           "nan",
                           "0x10",
                           "9223372036854775808",
                           "9223372037G",
                           "18446744074G",
                           "99999999999999999999"})
    EXPECT_THROW(parse_count(text), InputError) << "'" << text << "'";
}

TEST(Counts, AreWrittenAsTheyAreRead) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(1000000), "1M");
  EXPECT_EQ(format_count(1500), "1500");
  for (std::uint64_t trial = 0; trial < 500; ++trial) {
    const std::uint64_t bits = PathRandom(2, trial).bits(0, Purpose::test);
    const std::uint64_t count = (bits >> (2 + bits % 60)) / 1000 * ((bits & 1) ? 1000 : 1);
    EXPECT_EQ(parse_count(format_count(count)), count);
  }
}

TEST(Bytes, AreBinary) {
  EXPECT_EQ(parse_bytes("512"), 512u);
  EXPECT_EQ(parse_bytes("512B"), 512u);
  for (const char* text : {"64KiB", "64KB", "64K", "64k"}) EXPECT_EQ(parse_bytes(text), 65536u) << text;
  EXPECT_EQ(parse_bytes("300MiB"), 314572800u);
  EXPECT_EQ(parse_bytes("1.5GiB"), 1610612736u);
  EXPECT_EQ(parse_bytes("1TiB"), 1ull << 40);
  for (const char* text : {"", "KiB", "1iB", "1Ki", "1KiBB", "-1K", "1.0001K", "8388608TiB", "16777217TiB", "1PiB"})
    EXPECT_THROW(parse_bytes(text), InputError) << "'" << text << "'";
}

TEST(Sizes, AreWidthTimesHeight) {
  int width = 0, height = 0;
  parse_size("640x360", width, height);
  EXPECT_EQ(width, 640);
  EXPECT_EQ(height, 360);
  parse_size("1x65536", width, height);
  EXPECT_EQ(height, 65536);
  for (const char* text : {"", "x", "640", "640x", "x360", "0x1", "1x0", "-1x1", "65537x1", "640x360x2", "640X360",
                           "6 40x1", "640x360 ", "99999999999x1"})
    EXPECT_THROW(parse_size(text, width, height), InputError) << "'" << text << "'";
  EXPECT_EQ(height, 65536) << "an error leaves the values alone";
}

// Whatever bytes come, a parser answers with a value or an InputError.
TEST(AllParsers, TakeAnyBytes) {
  const std::string letters = "0123456789-,xykMGTiB.%#d \xff\n";
  for (std::uint64_t trial = 0; trial < 20000; ++trial) {
    const PathRandom random(3, trial);
    std::string text;
    const std::uint64_t length = random.bits(0, Purpose::test) % 9;
    for (std::uint32_t i = 1; i <= length; ++i) text += letters[random.bits(i, Purpose::test) % letters.size()];
    int width = 0, height = 0;
    const auto answers = [&](auto&& parse) {
      try {
        parse();
      } catch (const InputError& error) { EXPECT_NE(std::string(error.what()), ""); }
    };
    answers([&] { EXPECT_LE(parse_frames(text).size(), 1000000u); });
    answers([&] {
      const bool changes = has_frame_pattern(text) || text.find("%%") != text.npos;
      EXPECT_EQ(frame_name(text, 7) != text, changes);
    });
    answers([&] { EXPECT_LT(parse_count(text), 1ull << 63); });
    answers([&] { EXPECT_LT(parse_bytes(text), 1ull << 63); });
    answers([&] { parse_size(text, width, height); });
  }
}

}  // namespace
}  // namespace tempolux::tools
