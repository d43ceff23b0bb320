#include "formats/irradcache/irradcache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <limits>
#include <thread>

#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

constexpr std::uint32_t kAllColumns = column_influence | column_update | column_clearance | column_noise;
const std::string kPage = "../formats/irradcache/irradcache.md", kFiles = "formats/irradcache/";

std::string bytes_of(const IrradcacheHeader& header, const std::vector<std::vector<IrradianceCacheRecord>>& parts) {
  std::string bytes;
  IrradcacheWriter writer(
      [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }, header);
  for (const auto& part : parts) writer.write(part);
  writer.finish();
  return bytes;
}

void read(const std::string& path) { load_irradcache(path); }

/// A record whose every field depends on i.
IrradianceCacheRecord record(std::uint32_t i, std::uint32_t columns = 0) {
  const float x = float(i);
  IrradianceCacheRecord r;
  r.position = {x, 1.0f / (x + 1), -x * 0.37f};
  r.normal = i % 2 ? std::array<float, 3>{0.6f, 0, -0.8f} : std::array<float, 3>{0, 0.28f, 0.96f};
  r.object = std::uint16_t(i * 31);
  r.set = SurfaceSet(i % 2);
  r.irradiance = {float(i % 7) * 1e-3f, 1.0f / (x + 3), x * 1e5f};
  r.rotational = {{{x, -x, 1}, {2, x, -3}, {4, 5, 1e-20f * x}}};
  r.translational = {{{-x, x, -1}, {-2, -x, 3}, {-4, -5, 1e20f}}};
  r.radius = 1.0f / (x + 2);
  r.radius_unclamped = i % 3 ? x : std::numeric_limits<float>::infinity();
  if (columns & column_influence) r.influence = x + 0.5f;
  if (columns & column_update) r.update = {-x, x, 1};
  if (columns & column_clearance) r.clearance_reach = x + 1, r.clearance = {std::uint8_t(i), 0, 255};
  if (columns & column_noise) r.noise = {x, -x, -1};
  return r;
}
std::vector<IrradianceCacheRecord> records(std::uint32_t count, std::uint32_t columns = 0, std::uint32_t first = 0) {
  std::vector<IrradianceCacheRecord> all;
  for (std::uint32_t i = first; i < first + count; ++i) all.push_back(record(i, columns));
  return all;
}

IrradcacheHeader rich_header() {
  IrradcacheHeader header;
  header.history = "0.1.0 photon-trace scene.glb\n0.1.0 irradcache-build records scene.glb\n";
  header.identity = {"g1", "m1", "a1", "l1", "v1", -3, 20};
  header.origin = {1e6, -0.1, 3};
  header.columns = kAllColumns;
  header.rays = 900;
  header.error_bound = 0.15;
  header.least_cosine = 0.985;
  header.lamps_apart = 0.125;
  header.min_radius = 0.001;
  header.max_radius = 2.5;
  header.placed_frames = {{-3, 0}, {2, 2}, {5, 20}};
  return header;
}

// If this fails the format has changed. That takes a new version number in irradcache.md, not a new example.
TEST(Irradcache, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  IrradcacheHeader header;
  header.history = "example\n";
  header.identity.static_geometry = "a1";
  header.identity.materials = "b2";
  header.identity.lights = "c3";
  header.identity.last_frame = 23;
  header.rays = 512;
  header.error_bound = 0.25;
  header.min_radius = 0.01;
  header.max_radius = 1.5;
  header.placed_frames = {{0, 23}, {30, 30}};
  IrradianceCacheRecord r;
  r.position = {1, 2, 3};
  r.normal = {0, 1, 0};
  r.object = 7;
  r.irradiance = {0.5f, 0.25f, 0.125f};
  r.rotational = {{{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
  r.translational = {{{-1, 0, 0}, {0, -2, 0}, {0, 0, -3}}};
  r.radius = 0.5f;
  r.radius_unclamped = 2;
  const std::string bytes = bytes_of(header, {{r}});
  EXPECT_EQ(bytes, worked_example(kPage));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.irradcache"));
  EXPECT_NE(load(kPage).find(std::to_string(bytes.size()) + " bytes"), std::string::npos) << bytes.size();
}

TEST(Irradcache, WorkedExampleReadsAsThePageSays) {
  const IrradcacheFile file = load_irradcache(kFiles + "accept/worked-example.irradcache");
  ASSERT_EQ(file.records.size(), 1u);
  EXPECT_EQ(file.records[0].rotational[2], (std::array<float, 3>{0, 0, 3}));
  EXPECT_EQ(file.records[0].translational[1], (std::array<float, 3>{0, -2, 0}));
  EXPECT_EQ(file.totals, (IrradcacheTotals{1, {0.5, 0.25, 0.125}}));
  EXPECT_NE(load(kPage).find("digest is " + digest_of(file)), std::string::npos) << digest_of(file);
}

TEST(Irradcache, EverythingComesBack) {
  Folder folder;
  const IrradcacheHeader expected = rich_header();
  save(folder / "a", bytes_of(expected, {records(3, kAllColumns), records(2, kAllColumns, 3)}));
  const IrradcacheFile file = load_irradcache(folder / "a");
  EXPECT_EQ(file.header.history, expected.history);
  EXPECT_EQ(file.header.identity, expected.identity);
  EXPECT_EQ(file.header.origin, expected.origin);
  EXPECT_EQ(file.header.columns, expected.columns);
  EXPECT_EQ(file.header.rays, expected.rays);
  EXPECT_EQ(file.header.error_bound, expected.error_bound);
  EXPECT_EQ(file.header.least_cosine, expected.least_cosine);
  EXPECT_EQ(file.header.lamps_apart, expected.lamps_apart);
  EXPECT_EQ(file.header.min_radius, expected.min_radius);
  EXPECT_EQ(file.header.max_radius, expected.max_radius);
  EXPECT_EQ(file.header.placed_frames, expected.placed_frames);
  EXPECT_EQ(file.records, records(5, kAllColumns));
  EXPECT_EQ(file.totals.irradiance[2], 1e6);  // 1e5 (0 + 1 + 2 + 3 + 4), each exact in float32
}

TEST(Irradcache, WhatIsNotKnownOfTheGatheringComesBackAsNotKnown) {
  Folder folder;
  save(folder / "a", bytes_of({}, {}));
  const IrradcacheFile file = load_irradcache(folder / "a");
  EXPECT_EQ(file.header.rays, 0u);
  EXPECT_EQ(file.header.error_bound, 0);
  EXPECT_EQ(file.header.least_cosine, kLeastCosine);
  EXPECT_EQ(file.header.max_radius, 0);
  EXPECT_TRUE(file.header.placed_frames.empty());
  EXPECT_FALSE(file.header.identity.known());
  EXPECT_TRUE(file.records.empty());
}

// Columns: 4, 12, 20 and 12 bytes per record; "none", "influence", "influence,update,clearance,noise" are 4, 9 and 32
// letters.
TEST(Irradcache, ColumnsThatAreNotNamedTakeNoRoom) {
  IrradcacheHeader header;
  const auto size_of = [&](std::uint32_t columns) {
    header.columns = columns;
    return bytes_of(header, {records(100, columns)}).size();
  };
  EXPECT_EQ(size_of(column_influence) - size_of(0), 400u + 9 - 4);
  EXPECT_EQ(size_of(kAllColumns) - size_of(column_influence), 4400u + 32 - 9);
}

TEST(Irradcache, ManyRecordsAreCutIntoBlocksAndComeBackInOrder) {
  Folder folder;
  save(folder / "a", bytes_of(rich_header(), {records(70000, kAllColumns), records(10, kAllColumns, 70000)}));
  EXPECT_EQ(load_irradcache(folder / "a").records, records(70010, kAllColumns));
}

TEST(Irradcache, APipeCanBeRead) {
  Folder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::string bytes = bytes_of(rich_header(), {records(20000, kAllColumns)});
  std::thread writing([&] { save(folder / "pipe", bytes); });
  const IrradcacheFile file = load_irradcache(folder / "pipe");
  writing.join();
  EXPECT_EQ(file.records.size(), 20000u);
}

TEST(Irradcache, EveryTruncationIsAnError) {
  expect_every_truncation_refused(bytes_of(rich_header(), {records(2, kAllColumns), records(1, kAllColumns, 2)}), read);
}

TEST(Irradcache, EveryFlippedBitIsAnError) {
  expect_every_flipped_bit_refused(bytes_of(rich_header(), {records(2, kAllColumns), records(1, kAllColumns, 2)}),
                                   read);
}

TEST(Irradcache, AcceptsEveryFileOfTheFolderAccept) { EXPECT_GE(expect_files(kFiles + "accept", true, read), 15); }

TEST(Irradcache, RefusesEveryFileOfTheFolderRefuse) { EXPECT_GE(expect_files(kFiles + "refuse", false, read), 70); }

// 65536 records of 120 bytes.
TEST(Irradcache, CountsAreComparedWithTheBytesLeft) {
  Folder folder;
  const std::string block = load(kFiles + "refuse/block-count-beyond-end.irradcache");
  EXPECT_NE(fault_of(folder, block, read).find("7864320 bytes should follow"), std::string::npos)
      << fault_of(folder, block, read);
}

// 2^60 + 2^7 + 2^7: each 2^7 alone is half a unit in the last place of a float64 2^60 and lost; together they
// are one.
TEST(Irradcache, TheTotalIsExactForAnyOrderAndCut) {
  Folder folder;
  const auto of = [](float x) {
    IrradianceCacheRecord r;
    r.irradiance = {0, x, 0};
    return r;
  };
  const float large = 0x1p60f, small = 0x1p7f;
  for (const auto& parts : std::vector<std::vector<std::vector<IrradianceCacheRecord>>>{
           {{of(large), of(small), of(small)}}, {{of(small)}, {of(large)}, {of(small)}}}) {
    save(folder / "a", bytes_of({}, parts));
    EXPECT_EQ(load_irradcache(folder / "a").totals.irradiance, (std::array<double, 3>{0, 0x1p60 + 0x1p8, 0}));
  }
}

TEST(Irradcache, DigestIsOfTheDataAlone) {
  Folder folder;
  const auto digest = [&](const IrradcacheHeader& header,
                          const std::vector<std::vector<IrradianceCacheRecord>>& parts) {
    save(folder / "a", bytes_of(header, parts));
    return digest_of(load_irradcache(folder / "a"));
  };
  const IrradcacheHeader header = rich_header();
  const std::string whole = digest(header, {records(5, kAllColumns)});
  EXPECT_EQ(digest(header, {records(2, kAllColumns), {}, records(3, kAllColumns, 2)}), whole);
  IrradcacheHeader other;  // no history, no identity, nothing of the gathering
  other.origin = header.origin;
  other.columns = header.columns;
  EXPECT_EQ(digest(other, {records(5, kAllColumns)}), whole);
  other.origin[1] = 0;
  EXPECT_NE(digest(other, {records(5, kAllColumns)}), whole);
  other = header;
  other.columns = 0;
  const std::string bare = digest(other, {records(5)});
  EXPECT_NE(bare, whole);
  other.columns = kAllColumns;
  std::vector<IrradianceCacheRecord> zeros = records(5);
  for (auto& r : zeros) r.clearance_reach = 1;  // which cannot be 0
  EXPECT_NE(digest(other, {zeros}), bare);      // a column of zeros is more than no column
  const auto changed = [&](const std::function<void(IrradianceCacheRecord&)>& change) {
    std::vector<IrradianceCacheRecord> all = records(5, kAllColumns);
    change(all[4]);
    return digest(header, {all});
  };
  EXPECT_NE(changed([](auto& r) { r.radius_unclamped += 1; }), whole);
  EXPECT_NE(changed([](auto& r) { r.position[0] += 1; }), whole);
  EXPECT_NE(changed([](auto& r) { r.influence += 1; }), whole);
  EXPECT_NE(changed([](auto& r) { r.update[2] += 1; }), whole);
  EXPECT_NE(changed([](auto& r) { r.clearance[1] ^= 1; }), whole);
  EXPECT_NE(changed([](auto& r) { r.noise[2] += 1; }), whole);
  EXPECT_EQ(changed([](auto& r) { r.reserved = 1; }), whole);
  IrradcacheFile file = load_irradcache(folder / "a");
  file.records[1].reserved = 1;  // never so in a file that was read, but in one made in memory
  EXPECT_EQ(digest_of(file), whole);
}

TEST(Irradcache, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto sink = [](const void*, std::size_t) {};
  IrradcacheHeader plain = rich_header();
  plain.columns = 0;
  IrradcacheWriter writer(sink, plain);
  const auto refused = [&](const std::function<void(IrradianceCacheRecord&)>& change) {
    std::vector<IrradianceCacheRecord> bad = records(3);
    change(bad[2]);
    EXPECT_THROW(writer.write(bad), std::invalid_argument);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  refused([&](auto& r) { r.position[1] = nan; });
  refused([&](auto& r) { r.normal = {}; });
  refused([&](auto& r) { r.normal = {0, 0, 1.0002f}; });  // its square is 1.0004
  refused([&](auto& r) { r.set = SurfaceSet(2); });
  refused([&](auto& r) { r.irradiance[2] = -1e-45f; });
  refused([&](auto& r) { r.rotational[1][2] = nan; });
  refused([&](auto& r) { r.translational[2][0] = inf; });
  refused([&](auto& r) { r.radius = 0; });
  refused([&](auto& r) { r.radius = inf; });
  refused([&](auto& r) { r.radius_unclamped = nan; });
  refused([&](auto& r) { r.radius_unclamped = -inf; });
  refused([&](auto& r) { r.influence = 1e-45f; });  // columns the header does not name
  refused([&](auto& r) { r.update[0] = -1; });
  refused([&](auto& r) { r.clearance_reach = 1; });
  refused([&](auto& r) { r.noise[1] = 1; });
  std::vector<IrradianceCacheRecord> good = records(3);
  good[0].normal = {0, 0, 1.00009f};
  EXPECT_NO_THROW(writer.write(good));
  EXPECT_EQ(writer.finish().record_count, 3u);
  EXPECT_THROW(writer.finish(), std::invalid_argument);
  const auto header_refused = [&](const std::function<void(IrradcacheHeader&)>& change) {
    IrradcacheHeader bad = rich_header();
    change(bad);
    EXPECT_THROW(IrradcacheWriter(sink, bad), std::invalid_argument);
  };
  header_refused([&](auto& h) { h.columns = 16; });
  header_refused([&](auto& h) { h.error_bound = double(nan); });
  header_refused([&](auto& h) { h.min_radius = 3; });
  header_refused([&](auto& h) { h.max_radius = double(inf); });
  header_refused([&](auto& h) { h.placed_frames = {{2, 1}}; });
  header_refused([&](auto& h) { h.placed_frames = {{0, 3}, {4, 5}}; });
  header_refused([&](auto& h) { h.identity = {"g", "", "", "", "", 0, -1}; });
}

// For read_irrad_test.sh: files and, per file, what the second reader must find.
TEST(Irradcache, FilesForTheSecondReader) {
  const char* name = std::getenv("TEMPOLUX_SECOND_READER");
  if (!name) GTEST_SKIP() << "only for read_irrad_test.sh";
  const std::string folder = std::string(name) + "/";
  save(folder + "rich.irradcache", bytes_of(rich_header(), {records(66000, kAllColumns)}));
  save(folder + "plain.irradcache", bytes_of({}, {records(10)}));
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".irradcache") continue;
    const IrradcacheFile file = load_irradcache(entry.path());
    std::ofstream out(entry.path().string() + ".expected");
    out.precision(17);
    out << file.totals.record_count;
    for (double x : file.totals.irradiance) out << ' ' << x;
    out << '\n';
  }
}

}  // namespace
}  // namespace tempolux::formats
