#include "formats/irradpoints/irradpoints.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <limits>
#include <thread>

#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

const std::string kPage = "../formats/irradpoints/irradpoints.md", kFiles = "formats/irradpoints/";

std::string bytes_of(const IrradpointsHeader& header, const std::vector<std::vector<IrradiancePointRecord>>& parts) {
  std::string bytes;
  IrradpointsWriter writer(
      [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }, header);
  for (const auto& part : parts) writer.write(part);
  writer.finish();
  return bytes;
}

void read(const std::string& path) { load_irradpoints(path); }

/// A point whose every field depends on i, without caustic light.
IrradiancePointRecord point(std::uint32_t i) {
  IrradiancePointRecord p;
  p.position = {float(i), 1.0f / float(i + 1), -float(i) * 0.37f};
  p.normal = {std::uint16_t(i * 7919 % 65535), std::uint16_t(i * 104729 % 65535)};
  p.object = std::uint16_t(i * 31);
  p.set = SurfaceSet(i % 2);
  p.radius = float(i % 5) * 0.1f;
  p.direct = {float(i % 7) * 1e-3f, 1.0f / float(i + 3), float(i) * 1e5f};
  p.indirect = {float(i), 0, 1e-20f};
  return p;
}
std::vector<IrradiancePointRecord> points(std::uint32_t count, std::uint32_t first = 0) {
  std::vector<IrradiancePointRecord> all;
  for (std::uint32_t i = first; i < first + count; ++i) all.push_back(point(i));
  return all;
}

/// Two kinds, identity, history.
IrradpointsHeader header_of_two_kinds() {
  IrradpointsHeader header;
  header.history = "0.1.0 photon-trace scene.glb\n0.1.0 irradcache-build points scene.glb\n";
  header.identity = {"g1", "m1", "a1", "l1", "v1", -3, 20};
  header.origin = {1e6, -0.1, 3};
  header.spacing = 0.03;
  header.emitted_count = 12345;
  header.kinds = "direct,indirect";
  return header;
}

// If this fails the format has changed. That takes a new version number in irradpoints.md, not a new example.
TEST(Irradpoints, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  IrradpointsHeader header;
  header.history = "example\n";
  header.identity.static_geometry = "a1";
  header.identity.materials = "b2";
  header.identity.lights = "c3";
  header.identity.last_frame = 23;
  header.spacing = 0.05;
  header.emitted_count = 1000;
  header.kinds = "direct,indirect";
  IrradiancePointRecord a, b;
  a = {{1, 2, 3},   encode_normal({0, 1, 0}), 7, SurfaceSet::static_set, 0, 0.125f, {0.5f, 0.25f, 0.125f}, {},
       {2, 1, 0.5f}};
  b = {{-1, 0, 0.5f}, encode_normal({-1, 0, 0}), 8, SurfaceSet::dynamic_set, 0, 0, {}, {}, {0.25f, 0.25f, 0.25f}};
  const std::string bytes = bytes_of(header, {{a, b}});
  EXPECT_EQ(bytes, worked_example(kPage));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.irradpoints"));
  EXPECT_NE(load(kPage).find(std::to_string(bytes.size()) + " bytes"), std::string::npos) << bytes.size();
}

TEST(Irradpoints, WorkedExampleReadsAsThePageSays) {
  const IrradpointsFile file = load_irradpoints(kFiles + "accept/worked-example.irradpoints");
  ASSERT_EQ(file.records.size(), 2u);
  EXPECT_EQ(file.records[0].direct, (std::array<float, 3>{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(file.records[0].caustic, (std::array<float, 3>{}));
  EXPECT_EQ(file.records[0].indirect, (std::array<float, 3>{2, 1, 0.5f}));
  EXPECT_EQ(file.records[1].set, SurfaceSet::dynamic_set);
  EXPECT_EQ(file.totals, (IrradpointsTotals{2, {0.5, 0.25, 0.125}, {}, {2.25, 1.25, 0.75}}));
  EXPECT_NE(load(kPage).find("digest is " + digest_of(file)), std::string::npos) << digest_of(file);
}

TEST(Irradpoints, EverythingComesBack) {
  Folder folder;
  const IrradpointsHeader expected = header_of_two_kinds();
  save(folder / "a", bytes_of(expected, {points(3), points(2, 3)}));
  const IrradpointsFile file = load_irradpoints(folder / "a");
  EXPECT_EQ(file.header.history, expected.history);
  EXPECT_EQ(file.header.identity, expected.identity);
  EXPECT_EQ(file.header.origin, expected.origin);
  EXPECT_EQ(file.header.spacing, expected.spacing);
  EXPECT_EQ(file.header.emitted_count, expected.emitted_count);
  EXPECT_EQ(file.header.kinds, expected.kinds);
  EXPECT_EQ(file.records, points(5));
  EXPECT_EQ(file.totals.indirect[0], 10);  // 0 + 1 + 2 + 3 + 4
}

// 12 bytes per point and kind, beside the names.
TEST(Irradpoints, KindsThatAreNotNamedTakeNoRoom) {
  IrradpointsHeader header;
  header.spacing = 1;
  std::vector<IrradiancePointRecord> none(100);
  const auto size_of = [&](const char* kinds) {
    header.kinds = kinds;
    return bytes_of(header, {none}).size() - header.kinds.size();
  };
  EXPECT_EQ(size_of("direct,caustic,indirect") - size_of("direct,indirect"), 1200u);
  EXPECT_EQ(size_of("direct,indirect") - size_of("indirect"), 1200u);
}

// 12 bytes per point; the line `columns: noise` has 15 bytes.
TEST(Irradpoints, NoiseComesBackAndTakesRoomOnlyIfNamed) {
  Folder folder;
  IrradpointsHeader header = header_of_two_kinds();
  const std::size_t without = bytes_of(header, {points(100)}).size();
  header.columns = column_points_noise;
  std::vector<IrradiancePointRecord> noisy = points(100);
  for (std::size_t i = 0; i < noisy.size(); ++i) noisy[i].noise = {float(i), -1, 0.5f};
  const std::string bytes = bytes_of(header, {noisy});
  EXPECT_EQ(bytes.size() - without, 1200u + 15);
  save(folder / "a", bytes);
  const IrradpointsFile file = load_irradpoints(folder / "a");
  EXPECT_EQ(file.header.columns, std::uint32_t(column_points_noise));
  EXPECT_EQ(file.records, noisy);
}

TEST(Irradpoints, ManyPointsAreCutIntoBlocksAndComeBackInOrder) {
  Folder folder;
  save(folder / "a", bytes_of(header_of_two_kinds(), {points(150000), points(10, 150000)}));
  EXPECT_EQ(load_irradpoints(folder / "a").records, points(150010));
}

TEST(Irradpoints, APipeCanBeRead) {
  Folder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::string bytes = bytes_of(header_of_two_kinds(), {points(100000)});
  std::thread writing([&] { save(folder / "pipe", bytes); });
  const IrradpointsFile file = load_irradpoints(folder / "pipe");
  writing.join();
  EXPECT_EQ(file.records.size(), 100000u);
}

TEST(Irradpoints, EveryTruncationIsAnError) {
  expect_every_truncation_refused(bytes_of(header_of_two_kinds(), {points(2), points(1, 2)}), read);
}

TEST(Irradpoints, EveryFlippedBitIsAnError) {
  expect_every_flipped_bit_refused(bytes_of(header_of_two_kinds(), {points(2), points(1, 2)}), read);
}

TEST(Irradpoints, AcceptsEveryFileOfTheFolderAccept) { EXPECT_GE(expect_files(kFiles + "accept", true, read), 12); }

TEST(Irradpoints, RefusesEveryFileOfTheFolderRefuse) { EXPECT_GE(expect_files(kFiles + "refuse", false, read), 60); }

// 65536 points of 24 bytes and two kinds of 12.
TEST(Irradpoints, CountsAreComparedWithTheBytesLeft) {
  Folder folder;
  const std::string block = load(kFiles + "refuse/block-count-beyond-end.irradpoints");
  EXPECT_NE(fault_of(folder, block, read).find("3145728 bytes should follow"), std::string::npos)
      << fault_of(folder, block, read);
}

TEST(Irradpoints, MessagesNameOffsetOfTheRecord) {
  Folder folder;
  const std::string bytes = load(kFiles + "refuse/position-nan.irradpoints");
  const std::size_t offset = bytes.find("IRPT", 16) + 12;
  EXPECT_NE(fault_of(folder, bytes, read)
                .find("x.file: byte " + std::to_string(offset) + ": point 0 of the block: position is not finite; "),
            std::string::npos)
      << fault_of(folder, bytes, read);
}

// 2^60 + 2^7 + 2^7: each 2^7 alone is half a unit in the last place of a float64 2^60 and lost; together they
// are one.
TEST(Irradpoints, TotalsAreExactForAnyOrderAndCut) {
  Folder folder;
  const float large = 0x1p60f, small = 0x1p7f;
  const auto of = [](float x) {
    IrradiancePointRecord p;
    p.direct = {x, 0, x};
    return p;
  };
  for (const auto& parts : std::vector<std::vector<std::vector<IrradiancePointRecord>>>{
           {{of(large), of(small), of(small)}}, {{of(small)}, {of(large)}, {of(small)}}}) {
    save(folder / "a", bytes_of(header_of_two_kinds(), parts));
    EXPECT_EQ(load_irradpoints(folder / "a").totals.direct, (std::array<double, 3>{0x1p60 + 0x1p8, 0, 0x1p60 + 0x1p8}));
  }
}

TEST(Irradpoints, DigestIsOfTheDataAlone) {
  Folder folder;
  const auto digest = [&](const IrradpointsHeader& header,
                          const std::vector<std::vector<IrradiancePointRecord>>& parts) {
    save(folder / "a", bytes_of(header, parts));
    return digest_of(load_irradpoints(folder / "a"));
  };
  const IrradpointsHeader header = header_of_two_kinds();
  const std::string whole = digest(header, {points(5)});
  EXPECT_EQ(digest(header, {points(2), {}, points(3, 2)}), whole);
  IrradpointsHeader other = header;
  other.history.clear();
  other.identity = {};
  other.emitted_count = 1;
  EXPECT_EQ(digest(other, {points(5)}), whole);
  other.spacing *= 2;
  EXPECT_NE(digest(other, {points(5)}), whole);
  other = header;
  other.origin[1] = 0;
  EXPECT_NE(digest(other, {points(5)}), whole);
  other = header;
  other.kinds = "direct,caustic,indirect";
  EXPECT_NE(digest(other, {points(5)}), whole);  // caustic known to be 0 is more than caustic unknown
  std::vector<IrradiancePointRecord> changed = points(5);
  changed[4].indirect[2] *= 1.0000001f;
  EXPECT_NE(digest(header, {changed}), whole);
  other = header;
  other.columns = column_points_noise;
  const std::string with_noise = digest(other, {points(5)});
  EXPECT_NE(with_noise, whole);
  changed = points(5);
  changed[3].noise[1] = -1;
  EXPECT_NE(digest(other, {changed}), with_noise);
  changed = points(5);
  std::swap(changed[0], changed[1]);
  EXPECT_NE(digest(header, {changed}), whole);
  changed = points(5);
  changed[2].reserved = 7;
  EXPECT_EQ(digest(header, {changed}), whole);
  IrradpointsFile file = load_irradpoints(folder / "a");
  file.records[1].reserved = 1;  // never so in a file that was read, but in one made in memory
  EXPECT_EQ(digest_of(file), whole);
}

TEST(Irradpoints, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto sink = [](const void*, std::size_t) {};
  IrradpointsWriter writer(sink, header_of_two_kinds());
  const auto refused = [&](const std::function<void(IrradiancePointRecord&)>& change) {
    std::vector<IrradiancePointRecord> bad = points(3);
    change(bad[2]);
    EXPECT_THROW(writer.write(bad), std::invalid_argument);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  refused([&](auto& p) { p.position[1] = nan; });
  refused([&](auto& p) { p.normal[0] = 65535; });
  refused([&](auto& p) { p.set = SurfaceSet(2); });
  refused([&](auto& p) { p.radius = -1; });
  refused([&](auto& p) { p.direct[2] = inf; });
  refused([&](auto& p) { p.indirect[0] = -1e-45f; });
  refused([&](auto& p) { p.noise[0] = 1; });         // without its column
  refused([&](auto& p) { p.caustic[0] = 1e-45f; });  // a kind the header does not name
  EXPECT_NO_THROW(writer.write(points(3)));
  EXPECT_EQ(writer.finish().point_count, 3u);
  EXPECT_THROW(writer.write(points(1)), std::invalid_argument);
  const auto header_refused = [&](const std::function<void(IrradpointsHeader&)>& change) {
    IrradpointsHeader bad = header_of_two_kinds();
    change(bad);
    EXPECT_THROW(IrradpointsWriter(sink, bad), std::invalid_argument);
  };
  header_refused([&](auto& h) { h.kinds = "indirect,direct"; });
  header_refused([&](auto& h) { h.columns = 2; });
  header_refused([&](auto& h) { h.spacing = 0; });
  header_refused([&](auto& h) { h.spacing = double(nan); });
  header_refused([&](auto& h) { h.origin[0] = double(inf); });
  header_refused([&](auto& h) { h.history = "no line feed"; });
  header_refused([&](auto& h) { h.history = "line\x1b[2J\n"; });
  header_refused([&](auto& h) { h.identity.media = "two words"; });
}

// For read_irrad_test.sh: files and, per file, what the second reader must find.
TEST(Irradpoints, FilesForTheSecondReader) {
  const char* name = std::getenv("TEMPOLUX_SECOND_READER");
  if (!name) GTEST_SKIP() << "only for read_irrad_test.sh";
  const std::string folder = std::string(name) + "/";
  save(folder + "rich.irradpoints", bytes_of(header_of_two_kinds(), {points(70000)}));
  IrradpointsHeader one;
  one.spacing = 1e-3;
  one.kinds = "caustic";
  std::vector<IrradiancePointRecord> caustic(3);
  caustic[1].caustic = {0.1f, 0.2f, 0.3f};
  save(folder + "plain.irradpoints", bytes_of(one, {caustic}));
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".irradpoints") continue;
    const IrradpointsFile file = load_irradpoints(entry.path());
    std::ofstream out(entry.path().string() + ".expected");
    out.precision(17);
    out << file.totals.point_count;
    for (const auto& total : {file.totals.direct, file.totals.caustic, file.totals.indirect})
      for (double x : total) out << ' ' << x;
    out << '\n';
  }
}

}  // namespace
}  // namespace tempolux::formats
