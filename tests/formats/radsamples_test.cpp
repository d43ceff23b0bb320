#include "formats/radsamples/radsamples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

const std::string kPage = "../formats/radsamples/radsamples.md", kFiles = "formats/radsamples/";

std::string bytes_of(const RadsamplesFile& file) {
  std::string bytes;
  write_radsamples([&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                   file);
  return bytes;
}
void read(const std::string& path) { load_radsamples(path); }

/// The file of the page's worked example.
RadsamplesFile example() {
  RadsamplesFile file;
  file.header.history = "example\n";
  file.header.identity = {"a1", "", "b2", "c3", "", 2, 2};
  file.header.diagonal = 8;
  file.header.segment = {0, 23};
  file.header.anchors = true;
  file.header.points_hash = "d4";
  file.point_light = {{1, 2, 3}, {0.5f, 0.25f, 0}};
  RadsamplesRecord& r = file.records.emplace_back();
  r.position = {1, 2, 3};
  r.normal = {0, 1, 0};
  r.key = 0x0123456789abcdef;
  r.surface = 4;
  r.triangle = 5;
  r.barycentric = {0.25f, 0.5f};
  r.updates = 2;
  r.object = 7;
  r.footprint = 0.125f;
  r.expected_share = 0.75f;
  r.lit_share = 0.5f;
  r.radius = 0.5f;
  r.radius_unclamped = 2;
  r.irradiance = {0.5f, 0.25f, 0.125f};
  r.rotational = {{{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
  r.translational = {{{-1, 0, 0}, {0, -2, 0}, {0, 0, -3}}};
  for (std::uint8_t k = 0; k < 16; ++k) r.clearance[k] = k;
  r.further_share = 0.25f;
  file.samples = {{{128, 64, 0, 128}, 0x5800, 1 | sample_valid | sample_anchored},
                  {{200, 100, 50, 129}, 0x5400, 3 | sample_valid | sample_near | sample_dynamic},
                  {{}, 0, 2 | sample_valid | sample_miss}};
  file.anchors = {1, 0xffffffff, 0xffffffff};
  return file;
}

/// So many records of 12 cells, every field of which depends on its number.
RadsamplesFile many(std::uint32_t count) {
  RadsamplesFile file = example();
  file.records.clear(), file.samples.clear(), file.anchors.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    RadsamplesRecord r = example().records[0];
    r.rings = 3, r.sectors = 4;
    r.key = i * 0x123456789ull;
    r.irradiance = {float(i), 1.0f / float(i + 1), 0};
    r.radius_unclamped = i % 2 ? 3.0f : std::numeric_limits<float>::infinity();
    r.narrows_from = i;
    file.records.push_back(r);
    for (std::uint32_t c = 0; c < 12; ++c) {
      file.samples.push_back({{std::uint8_t(i), std::uint8_t(c), 3, 130},
                              std::uint16_t(0x0400 + i % 1000),
                              std::uint16_t((1 + c) | sample_valid)});
      file.anchors.push_back(0xffffffff);
    }
  }
  return file;
}

// If this fails the format has changed. That takes a new version number in radsamples.md, not a new example.
TEST(Radsamples, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  const std::string bytes = bytes_of(example());
  EXPECT_EQ(bytes, worked_example(kPage));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.radsamples"));
  EXPECT_NE(load(kPage).find(std::to_string(bytes.size()) + " bytes"), std::string::npos) << bytes.size();
}

TEST(Radsamples, WorkedExampleReadsAsThePageSays) {
  const RadsamplesFile file = load_radsamples(kFiles + "accept/worked-example.radsamples");
  EXPECT_EQ(file.records, example().records);
  EXPECT_EQ(file.samples, example().samples);
  EXPECT_EQ(file.anchors, example().anchors);
  EXPECT_EQ(file.point_light, example().point_light);
  EXPECT_EQ(decode_rgbe(file.samples[0].rgbe), (std::array<float, 3>{0.5f, 0.25f, 0}));
  EXPECT_EQ(decode_half(file.samples[0].distance) * 8 / 1024, 1);
  EXPECT_EQ(decode_half(file.samples[1].distance) * 8 / 1024, 0.5f);
  EXPECT_NE(load(kPage).find("digest is " + digest_of(file)), std::string::npos) << digest_of(file);
}

// 8 bytes a sample, 4 its anchor, 200 a record, 12 a block's head: the size to expect, header + 8 N #E, and the rest as
// said.
TEST(Radsamples, ManyComeBackAndTakeTheRoomThePageSays) {
  Folder folder;
  const RadsamplesFile file = many(6000);  // 72000 samples: two blocks
  const std::string bytes = bytes_of(file);
  EXPECT_EQ(bytes.size() - bytes_of(many(0)).size(), 6000u * (200 + 12 * 12) + 3 * 12);
  save(folder / "a", bytes);
  const RadsamplesFile again = load_radsamples(folder / "a");
  EXPECT_EQ(again.records, file.records);
  EXPECT_EQ(again.samples, file.samples);
  EXPECT_EQ(again.anchors, file.anchors);
  EXPECT_EQ(again.header.segment, file.header.segment);
  EXPECT_EQ(again.header.identity, file.header.identity);
  EXPECT_EQ(bytes_of(again), bytes);
}

TEST(Radsamples, EveryTruncationIsAnError) { expect_every_truncation_refused(bytes_of(example()), read); }
TEST(Radsamples, EveryFlippedBitIsAnError) { expect_every_flipped_bit_refused(bytes_of(example()), read); }
TEST(Radsamples, AcceptsEveryFileOfTheFolderAccept) { EXPECT_GE(expect_files(kFiles + "accept", true, read), 14); }
TEST(Radsamples, RefusesEveryFileOfTheFolderRefuse) { EXPECT_GE(expect_files(kFiles + "refuse", false, read), 60); }

TEST(Radsamples, DigestIsOfTheDataAlone) {
  RadsamplesFile file = example();
  const std::string whole = digest_of(file);
  file.header.history = "other\n", file.header.identity = {};
  EXPECT_EQ(digest_of(file), whole);
  file.samples[1].flags += 1;
  EXPECT_NE(digest_of(file), whole);
  file = example();
  file.header.diagonal = 9;
  EXPECT_NE(digest_of(file), whole);
  file = example();
  file.point_light[0][0] = 2;
  EXPECT_NE(digest_of(file), whole);
}

TEST(Radsamples, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto refused = [](const std::function<void(RadsamplesFile&)>& change) {
    RadsamplesFile file = example();
    change(file);
    EXPECT_THROW(bytes_of(file), std::invalid_argument);
  };
  refused([](auto& f) { f.samples.pop_back(); });
  refused([](auto& f) { f.anchors.pop_back(); });
  refused([](auto& f) { f.header.diagonal = 0; });
  refused([](auto& f) { f.header.base_name = "a", f.header.base_digest = std::string(32, '0'); });
  refused([](auto& f) { f.kept_from = {1}; });
  refused([](auto& f) { f.header.base_name = "a", f.kept_from = {1}; });
  refused([](auto& f) { f.header.points_hash = ""; });
  refused([](auto& f) { f.records[0].radius = NAN; });
  refused([](auto& f) { f.samples[0].flags = sample_valid; });
  refused([](auto& f) { f.anchors[0] = 2; });
  refused([](auto& f) { f.point_light[1][1] = -1; });
  refused([](auto& f) { f.header.high_hash = "a b"; });
}

// Samples come record by record; a file that is not finished is none.
TEST(Radsamples, AWriterTakesAllRecordsAndNoMore) {
  RadsamplesFile head = many(2);
  const std::vector<RadianceSample> samples = std::exchange(head.samples, {});
  const std::vector<std::uint32_t> anchors = std::exchange(head.anchors, {});
  std::string bytes;
  RadsamplesWriter writer(
      [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }, head);
  const std::span s(samples), twelve = s.first(12);
  const std::span<const std::uint32_t> a(anchors);
  EXPECT_THROW(writer.write(s.first(11), a.first(11)), std::invalid_argument);
  EXPECT_THROW(writer.write(twelve, {}), std::invalid_argument);
  writer.write(twelve, a.first(12));
  EXPECT_THROW(writer.finish(), std::invalid_argument);
  writer.write(s.subspan(12), a.subspan(12));
  EXPECT_THROW(writer.write(twelve, a.first(12)), std::invalid_argument);
  writer.finish();
  EXPECT_EQ(bytes, bytes_of(many(2)));
}

// The key `high` makes version 1.2; an overlay and its base both have it, or neither.
TEST(Radsamples, SamplesOfTheLowPartSaySo) {
  Folder folder;
  RadsamplesFile file = many(12);
  file.header.high_hash = "77";
  const std::string bytes = bytes_of(file);
  EXPECT_EQ(bytes[10], 2);
  EXPECT_EQ(digest_of(file), digest_of(many(12)));
  save(folder / "base.radsamples", bytes);
  EXPECT_EQ(load_radsamples(folder / "base.radsamples").header.high_hash, "77");
  RadsamplesFile overlay = many(12);
  overlay.header.base_name = "base.radsamples", overlay.header.base_digest = digest_of(file);
  overlay.kept_from = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  save(folder / "a", bytes_of(overlay));
  EXPECT_THROW(load_radsamples(folder / "a"), InputError);
  overlay.header.high_hash = "78";  // of another frame
  save(folder / "a", bytes_of(overlay));
  EXPECT_EQ(load_radsamples(folder / "a").samples, file.samples);
}

/// An overlay of many(12) whose odd records are the base's, in another order, with fields of their own; even ones have
/// other samples.
RadsamplesFile overlay_of_many(const std::string& base) {
  RadsamplesFile file = many(12);
  file.header.base_name = base;
  file.header.base_digest = digest_of(many(12));
  for (std::uint32_t i = 0; i < 12; ++i) {
    file.kept_from.push_back(i % 2 ? 12 - i : 0);  // of number 11 - i
    file.records[i].radius = 2;
    for (std::size_t c = 12 * i; c < 12 * i + 12; ++c) {
      if (i % 2) file.samples[c] = many(12).samples[12 * (11 - i) + c % 12];
      else file.samples[c].rgbe[0] = 77;
    }
  }
  return file;
}

// Six records of twelve keep 12 samples of 12 bytes each in the base; the keys of the base's name and digest come on
// top.
TEST(Radsamples, AnOverlayWithItsBaseIsTheFileWrittenWhole) {
  Folder folder;
  const RadsamplesFile file = overlay_of_many("base.radsamples");
  RadsamplesFile whole = file;
  whole.header.base_name = whole.header.base_digest = "", whole.kept_from.clear();
  const std::size_t keys = std::string("base: base.radsamples\nbase-digest: \n").size() + 32;
  EXPECT_EQ(bytes_of(file).size() + 6 * 12 * 12, bytes_of(whole).size() + keys);
  save(folder / "base.radsamples", bytes_of(many(12)));
  save(folder / "a", bytes_of(file));
  const RadsamplesFile again = load_radsamples(folder / "a");
  EXPECT_EQ(again.records, whole.records);
  EXPECT_EQ(again.samples, whole.samples);
  EXPECT_EQ(again.anchors, whole.anchors);
  EXPECT_EQ(again.kept_from, file.kept_from);
  EXPECT_EQ(digest_of(again), digest_of(whole));
  EXPECT_EQ(bytes_of(again), bytes_of(file));
}

TEST(Radsamples, AnOverlayTakesNoOtherBase) {
  Folder folder;
  const auto fault_with = [&](const RadsamplesFile& base) -> std::string {
    save(folder / "base.radsamples", bytes_of(base));
    save(folder / "a", bytes_of(overlay_of_many("base.radsamples")));
    try {
      load_radsamples(folder / "a");
    } catch (const InputError& error) { return error.what(); }
    return "";
  };
  const auto has = [](const std::string& fault, const char* words) { return fault.find(words) != fault.npos; };
  EXPECT_EQ(fault_with(many(12)), "");
  RadsamplesFile base = many(12);
  base.samples[3].rgbe[1] = 99;
  EXPECT_TRUE(has(fault_with(base), "another digest"));
  base = many(12), base.header.diagonal = 9;
  EXPECT_TRUE(has(fault_with(base), "other columns, points, segment or diagonal"));
  base = many(12), base.point_light.pop_back();
  EXPECT_TRUE(has(fault_with(base), "other columns, points, segment or diagonal"));
  EXPECT_TRUE(has(fault_with(overlay_of_many("base.radsamples")), "overlay itself"));
  RadsamplesFile file = overlay_of_many("base.radsamples");
  save(folder / "base.radsamples", bytes_of(many(12)));
  file.kept_from[1] = 13;  // the base has twelve
  save(folder / "a", bytes_of(file));
  EXPECT_THROW(load_radsamples(folder / "a"), InputError);
}

// Mantissas are 128 to 255 of the largest channel: reading back is off by less than 2^-7 of it; what a file holds comes
// back for any u.
TEST(RadianceSample, RgbeComesBackWithinAStepFromEndToEnd) {
  for (float exponent = -117; exponent < 126; exponent += 0.37f) {
    const std::array<float, 3> radiance{std::exp2(exponent), std::exp2(exponent - 1.3f), std::exp2(exponent - 6.9f)};
    for (const float u : {0.0f, 0.5f, 0.99999994f}) {
      const auto stored = encode_rgbe(radiance, {u, u, u});
      const auto back = decode_rgbe(stored);
      for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(std::abs(back[c] - radiance[c]), radiance[0] * 0x1p-7f) << exponent;
      for (const float v : {0.0f, 0.99999994f}) EXPECT_EQ(encode_rgbe(back, {v, v, v}), stored) << exponent << ' ' << u;
    }
  }
}

// The mean of floor(x + u) over u in [0, 1) is x; over 16 even steps of u within 1/32, a mantissa's step being at most
// 2^-7 of the largest channel. Rounded down, a value would lose half a step, and one that grows by a thousandth a frame
// would stay for good.
TEST(RadianceSample, RgbeIsRightInTheMean) {
  const auto step = [](int i) { return (float(i % 16) + 0.5f) / 16; };
  for (const std::array<float, 3>& radiance :
       {std::array{0.7003f, 0.3f, 0.0011f}, std::array{255.7f, 1.0f, 1e-3f}, std::array{1e-30f, 1e-31f, 0.0f}}) {
    std::array<double, 3> mean{};
    for (int i = 0; i < 4096; ++i) {
      const auto back = decode_rgbe(encode_rgbe(radiance, {step(i), step(i / 16), step(i / 256)}));
      for (std::size_t c = 0; c < 3; ++c) mean[c] += double(back[c]) / 4096;
    }
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(mean[c], double(radiance[c]), double(radiance[0]) * 0x1p-12) << radiance[0];
  }
}

TEST(RadianceSample, WhatIsNoRadianceIsDarkOrTheLargest) {
  const std::array<std::uint8_t, 4> dark{};
  EXPECT_EQ(encode_rgbe({NAN, -1, -0.0f}, {}), dark);
  EXPECT_EQ(encode_rgbe({0x1p-119f, 0, 0}, {}), dark);
  EXPECT_EQ(decode_rgbe(encode_rgbe({INFINITY, 0, 0}, {}))[0], 0x1p126f);
  EXPECT_EQ(decode_rgbe({255, 255, 255, 9})[0], 0);
  EXPECT_TRUE(std::isfinite(decode_rgbe({255, 0, 0, 255})[0]));
}

// binary16 has 11 bits: off by at most 2^-11 relatively, rounded to even.
TEST(RadianceSample, HalvesComeBackAndStayInTheirRange) {
  for (float x = 0x1p-14f; x < 65504; x *= 1.0137f) EXPECT_LE(std::abs(decode_half(encode_half(x)) - x), x * 0x1p-11f);
  EXPECT_EQ(encode_half(1), 0x3c00);
  EXPECT_EQ(encode_half(1 + 0x1p-11f), 0x3c00);  // half way: to the even one
  EXPECT_EQ(encode_half(1 + 3 * 0x1p-11f), 0x3c02);
  EXPECT_EQ(encode_half(1e-9f), 0x0400);
  EXPECT_EQ(encode_half(1e9f), 0x7bff);
  EXPECT_EQ(encode_half(INFINITY), 0x7bff);
  for (std::uint32_t h = 0x0400; h < 0x7c00; ++h) ASSERT_EQ(encode_half(decode_half(std::uint16_t(h))), h);
}

// For read_radsamples_test.sh: files to read a second time in Python, and what must come out.
TEST(Radsamples, FilesForTheSecondReader) {
  const char* folder = std::getenv("TEMPOLUX_SECOND_READER");
  if (!folder) GTEST_SKIP() << "only for read_radsamples_test.sh";
  const auto give = [&](const std::string& name, const RadsamplesFile& file) {
    save(std::string(folder) + "/" + name, bytes_of(file));
    double radiance = 0, ages = 0;
    for (const RadianceSample& s : file.samples) radiance += double(decode_rgbe(s.rgbe)[1]), ages += age_of(s);
    std::ofstream expected(std::string(folder) + "/" + name + ".expected");
    expected.precision(17);
    expected << file.point_light.size() << ' ' << file.records.size() << ' ' << file.samples.size() << ' ' << radiance
             << ' ' << ages << '\n';
  };
  give("example.radsamples", example());
  give("many.radsamples", many(6000));
  give("empty.radsamples", many(0));
  save(std::string(folder) + "/base.radsamples", bytes_of(many(12)));
  give("overlay.radsamples", overlay_of_many("base.radsamples"));
  RadsamplesFile low = many(30);
  low.header.high_hash = "77";
  give("low.radsamples", low);
}

}  // namespace
}  // namespace tempolux::formats
