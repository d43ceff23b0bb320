// Damaged and inconsistent EXR files lead to an InputError of one line, or to an image. They never cause a crash, or
// an allocation by an unchecked number.
#include <sys/resource.h>

#include <algorithm>

#include "formats/error.h"
#include "lib/core/random.h"
#include "lib/image/exr_io.h"
#include "tests/lib/image/image_fixture.h"

namespace tempolux {
namespace {

Image small_image() {
  Image image;
  image.width = 24;
  image.height = 40;  // three ZIP chunks
  const PathRandom random(3, 4);
  for (const char* name : {"R", "G", "B", "Z"})
    for (float& value : image.add(name).values)
      value = random.get1(0, Purpose::test, std::uint32_t(&value - image.channels.back().values.data()) / 5);
  image.add_ids("id.object").ids[7] = 9;
  image.text["tempolux:history"] = "0.1.0 test\n";
  image.matrices["worldToCamera"] = {};
  return image;
}

/// One line, naming the file.
void expect_good_message(const std::string& message, const std::string& file) {
  EXPECT_TRUE(message.starts_with(file + ": ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(message.size(), file.size() + 1200);
}

class ExrDamage : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Compressions, ExrDamage, testing::Bool());

TEST_P(ExrDamage, EveryTruncationIsAnError) {
  const Folder folder;
  save_exr(folder / "a.exr", small_image(), {false, GetParam()});
  const std::string whole = bytes_of(folder / "a.exr");
  const std::string cut = folder / "cut.exr";
  for (std::size_t size = 0; size < whole.size(); size += 64) {
    put_bytes(cut, whole.substr(0, size));
    const std::string message = message_of<InputError>([&] { load_exr(cut); });
    ASSERT_FALSE(message.empty()) << size;
    expect_good_message(message, cut);
  }
  put_bytes(cut, whole.substr(0, whole.size() - 1));
  EXPECT_THROW(load_exr(cut), InputError);
}

TEST_P(ExrDamage, FlippedBytesNeverCrash) {
  const Folder folder;
  save_exr(folder / "a.exr", small_image(), {false, GetParam()});
  const std::string whole = bytes_of(folder / "a.exr");
  const std::string bad = folder / "bad.exr";
  const PathRandom random(5, 6);
  int refused = 0;
  for (std::uint32_t i = 0; i < 400; ++i) {
    std::string bytes = whole;
    // Half of them in the header and the offset table, where the numbers are.
    const std::size_t range = i % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 700);
    const std::uint64_t bits = random.bits(i, Purpose::test);
    bytes[std::size_t(bits >> 16) % range] ^= char(1 + bits % 255);
    put_bytes(bad, bytes);
    try {
      const Image image = load_exr(bad);
      EXPECT_LE(image.pixel_count(), (256u << 20) / 8);  // at most 256 MiB, of at least two channels
    } catch (const InputError& error) {
      ++refused;
      expect_good_message(error.what(), bad);
    }
  }
  EXPECT_GT(refused, 40);
}

TEST(ExrDamageTable, AnUnfinishedFileIsRefused) {
  const Folder folder;
  save_exr(folder / "a.exr", small_image());
  std::string bytes = bytes_of(folder / "a.exr");
  // The offset table holds three increasing offsets, the first of which is the table's own end.
  for (std::size_t at = 8; at + 8 < bytes.size(); ++at) {
    std::uint64_t offset;
    std::memcpy(&offset, bytes.data() + at, 8);
    if (offset == at + 24) std::fill_n(bytes.begin() + std::ptrdiff_t(at) + 16, 8, '\0');
  }
  put_bytes(folder / "a.exr", bytes);
  const std::string message = message_of<InputError>([&] { load_exr(folder / "a.exr"); });
  EXPECT_NE(message.find("did not finish"), std::string::npos) << message;
}

/// Peak memory of this process in KiB.
long peak() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(ExrClaims, LyingHeadersAreRefusedBeforeMemoryIsTaken) {
  const Folder folder;
  const std::string path = folder / "a.exr";
  const std::string one = exr::box(0, 0, 0, 0),
                    rgb = exr::channel("B", 2) + exr::channel("G", 2) + exr::channel("R", 2);
  const auto refusal = [&](const std::string& bytes) {
    put_bytes(path, bytes + std::string(4096, '\0'));
    const std::string message = message_of<InputError>([&] { load_exr(path); });
    expect_good_message(message, path);
    return message;
  };
  const auto says = [&](const std::string& bytes, const std::string& what) {
    const std::string message = refusal(bytes);
    EXPECT_NE(message.find(what), std::string::npos) << message << "\nexpected: " << what;
  };
  const long before = peak();
  const auto big = [&](int w, int h) { return exr::box(0, 0, w - 1, h - 1); };
  says(exr::magic() + exr::header(rgb, big(60000, 60000), one, 3) + '\0', "over the limit");
  says(exr::magic() + exr::header(rgb, one, big(60000, 60000), 3) + '\0', "over the limit");
  says(exr::magic() + exr::header(rgb, one, big(20000, 20000), 3) + '\0', "crop the display window");
  says(exr::magic() + exr::header(rgb, big(70000, 2), one, 3) + '\0', "at most 65536 a side");
  says(exr::magic() + exr::header(rgb, exr::box(-2147483647, 0, 2147483647, 0), one, 3) + '\0', "out of range");
  says(exr::magic() + exr::header(rgb, exr::box(1, 0, 0, 0), one) + '\0', "empty");
  says(exr::magic() + exr::header(rgb, big(20000, 1000), one, 3) + '\0', "can hold");  // 240 MB from 4.5 kB
  says(exr::magic() + exr::header(rgb, big(1, 60000), one, 2) + '\0', "chunks");
  says(exr::magic(0x200) + exr::header(rgb, big(20000, 20000), one, 3) +
           exr::attribute("tiles", "tiledesc", raw(1u) + raw(1u) + '\0') + '\0',
       "chunks");
  says(exr::magic() + exr::attribute("comments", "string", "x").substr(0, 16) + raw(0x7fffffff),
       "claims 2147483647 bytes");
  // OpenEXR would not skip the number of bytes that the attribute states, so it would find other attributes behind it
  // than our reader.
  says(exr::magic() + exr::header(rgb, one, one) + exr::attribute("gamma", "float", std::string(36, '\0')) + '\0',
       "claims 36 bytes, its type has 4");
  says(exr::magic() + exr::header(rgb, one, one) + exr::attribute("more", "chlist", rgb + std::string(9, '\0')) + '\0',
       "shorter than it says");
  says(exr::magic() + exr::header(rgb, one, one) + exr::attribute("small", "preview", raw(20000) + raw(20000)) + '\0',
       "a preview of 20000 x 20000 pixels in 8 bytes");
  says(exr::magic(0x1000) + exr::header(rgb, one, one) + exr::attribute("chunkCount", "int", raw(0x7fffffff)) + '\0' +
           '\0',
       "chunks");
  says(exr::magic() + exr::header(exr::channel("RY", 2, 2), one, one) + '\0', "subsampled");
  says(exr::magic(0x800) + exr::header(rgb, one, one) + exr::attribute("type", "string", "deepscanline") + '\0',
       "deep");
  says(exr::magic() + exr::header("", one, one) + '\0', "no channels");
  says(exr::magic() + exr::header(rgb, one, one, 17) + '\0', "compression");
  says(raw(20000630) + raw(3), "version");
  says("#?RADIANCE", "byte 0: not an OpenEXR file");
  EXPECT_LT(peak() - before, 64 * 1024);
}

TEST(ExrClaims, TheLimitOfPixelsIsTheCallers) {
  const Folder folder;
  save_exr(folder / "a.exr", small_image());
  EXPECT_NO_THROW(load_exr(folder / "a.exr", {24 * 40}));
  EXPECT_THROW(load_exr(folder / "a.exr", {24 * 40 - 1}), InputError);
}

TEST(ExrClaims, AFlatImageIsSmallAndStillRead) {
  // 256 x 4096 equal pixels, 16 MiB of samples: deflate comes near its limit of 1032, which must not look
  // like a lie.
  const Folder folder;
  Image image;
  image.width = 256;
  image.height = 4096;
  for (const char* name : {"A", "B", "G", "R"}) image.add(name);
  save_exr(folder / "a.exr", image);
  EXPECT_LT(std::filesystem::file_size(folder / "a.exr"), (16u << 20) / 300);
  EXPECT_EQ(digest_of(load_exr(folder / "a.exr")), digest_of(image));
}

}  // namespace
}  // namespace tempolux
