#include "formats/photons/photons.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <regex>
#include <thread>

#include "tests/formats/photons_files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

constexpr std::uint32_t kAllColumns = column_direction | column_albedo;
const std::string kPage = "../formats/photons/photons.md", kFiles = "formats/photons/";

/// A small file with everything in it: groups, several blocks, columns, ledger, identity, history.
PhotonHeader rich_header() {
  PhotonHeader header;
  header.history = "0.1.0 photon-trace scene.glb\n0.1.0 photonmap-split -\n";
  header.identity = {"g1", "m1", "a1", "l1", "v1", -3, 20};
  header.origin = {1e6, -0.1, 3};
  header.columns = kAllColumns;
  header.group_count = 3;
  header.emitted_count = 12345;
  return header;
}
std::string rich_bytes() {
  const std::vector<PhotonBlock> blocks{block_of(0, 2, kAllColumns), block_of(0, 1, kAllColumns, 2),
                                        block_of(2, 2, kAllColumns)};
  return bytes_of(rich_header(), blocks, {}, ledger_of({0, 1, 2}));
}

void read(const std::string& path) { read_all(path); }

/// What reading says about these bytes; "" if they are good.
std::string fault_of(const Folder& folder, const std::string& bytes) { return testing::fault_of(folder, bytes, read); }

// If this fails the format has changed. That takes a new version number in photons.md, not a new example.
TEST(Photons, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  PhotonHeader header;
  header.history = "example\n";
  header.identity = {.static_geometry = "a1",
                     .moving_geometry = "",
                     .materials = "b2",
                     .lights = "c3",
                     .media = "",
                     .first_frame = 0,
                     .last_frame = 23};
  header.emitted_count = 4;
  PhotonBlock block;
  block.photons.push_back({{1, 2, 3}, {0.5f, 0.25f, 0.125f}, encode_normal({0, 1, 0}), 7, PathKind::caustic, 2});
  PhotonTotals totals;
  totals.emitted_flux = {1, 1, 1};
  totals.escaped_flux = totals.absorbed_flux = {0.5, 0.5, 0.5};
  const std::string bytes = bytes_of(header, {block}, totals);
  EXPECT_EQ(bytes, worked_example(kPage));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.photons"));
}

TEST(Photons, WorkedExampleReadsAsThePageSays) {
  const Contents all = read_all(kFiles + "accept/worked-example.photons");
  ASSERT_EQ(all.photon_count(), 1u);
  const Photon& p = all.groups[0].photons[0];
  EXPECT_EQ(p, (Photon{{1, 2, 3}, {0.5f, 0.25f, 0.125f}, {32767, 65534}, 7, PathKind::caustic, 2}));
  EXPECT_EQ(all.totals.stored_flux, (std::array<double, 3>{0.5, 0.25, 0.125}));
  EXPECT_EQ(all.header.history, "example\n");
  EXPECT_TRUE(all.header.identity.known());
  EXPECT_NE(load(kPage).find("Its digest is " + all.digest), std::string::npos) << all.digest;
}

TEST(Photons, EverythingComesBack) {
  Folder folder;
  save(folder / "a.photons", rich_bytes());
  const Contents all = read_all(folder / "a.photons");
  const PhotonHeader expected = rich_header();
  EXPECT_EQ(all.header.history, expected.history);
  EXPECT_EQ(all.header.identity, expected.identity);
  EXPECT_EQ(all.header.origin, expected.origin);
  EXPECT_EQ(all.header.columns, expected.columns);
  EXPECT_EQ(all.header.group_count, expected.group_count);
  EXPECT_EQ(all.header.emitted_count, expected.emitted_count);
  EXPECT_EQ(all.header.map, "global");
  EXPECT_EQ(all.header.kinds, expected.kinds);
  ASSERT_EQ(all.groups.size(), 2u);
  for (const auto& [i, block] :
       {std::pair(0, block_of(0, 3, kAllColumns)), std::pair(1, block_of(2, 2, kAllColumns))}) {
    EXPECT_EQ(all.groups[i].group, block.group);
    EXPECT_EQ(all.groups[i].photons, block.photons);
    EXPECT_EQ(all.groups[i].directions, block.directions);
    EXPECT_EQ(all.groups[i].albedos, block.albedos);
  }
  EXPECT_EQ(all.ledger, ledger_of({0, 1, 2}));
  EXPECT_DOUBLE_EQ(all.totals.emitted_flux[0], 3.3);
  EXPECT_EQ(load_photons(folder / "a.photons").photons.size(), 5u);
}

TEST(Photons, ManyPhotonsAreCutIntoBlocksAndComeBackInOrder) {
  Folder folder;
  const PhotonBlock block = block_of(0, 150000, 0);
  save(folder / "a.photons", bytes_of({}, {block, block_of(0, 10, 0)}));
  const PhotonMap map = load_photons(folder / "a.photons");
  ASSERT_EQ(map.photons.size(), 150010u);
  EXPECT_TRUE(std::equal(block.photons.begin(), block.photons.end(), map.photons.begin()));
  EXPECT_EQ(map.totals.photon_count, 150010u);
}

TEST(Photons, BlocksEncodedElsewhereGiveTheSameFile) {
  std::string bytes;
  PhotonWriter writer([&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                      rich_header());
  for (const PhotonBlock& block :
       {block_of(0, 2, kAllColumns), block_of(0, 1, kAllColumns, 2), block_of(2, 2, kAllColumns)})
    writer.write_encoded(encode_block(block, kAllColumns), block);
  writer.finish({}, ledger_of({0, 1, 2}));
  EXPECT_EQ(bytes, rich_bytes());
}

TEST(Photons, APipeCanBeRead) {
  Folder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::string bytes = bytes_of({}, {block_of(0, 100000, 0)});
  std::thread writing([&] { save(folder / "pipe", bytes); });
  const PhotonMap map = load_photons(folder / "pipe");
  writing.join();
  EXPECT_EQ(map.photons.size(), 100000u);
}

TEST(Photons, EveryTruncationIsAnError) { expect_every_truncation_refused(rich_bytes(), read); }

TEST(Photons, EveryFlippedBitIsAnError) { expect_every_flipped_bit_refused(rich_bytes(), read); }

TEST(Photons, MessagesNameFileOffsetReasonAndRemedy) {
  Folder folder;
  std::string broken = rich_bytes();
  broken[broken.find("PHOT", 16) + 20] ^= 1;
  const std::regex shape(".*/x\\.file: byte [0-9]+: [^;]+; .+");
  EXPECT_TRUE(std::regex_match(fault_of(folder, broken), shape)) << fault_of(folder, broken);
  EXPECT_TRUE(std::regex_match(fault_of(folder, "hello"), shape));
  try {
    load_photons(folder / "nowhere.photons");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere.photons: cannot open"), std::string::npos);
  }
  EXPECT_THROW(load_photons(folder / "."), InputError);
}

/// Largest resident memory of this process so far, bytes.
long peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024;
}

// A ledger of 2^24 groups would be 1.3 GB, and its checksum is never reached: what counts is that the error
// comes from comparing the count with the bytes left.
TEST(Photons, CountsAreComparedWithTheBytesLeftBeforeMemoryIsTaken) {
  Folder folder;
  PhotonHeader header;
  header.group_count = 1 << 24;
  std::string bytes = bytes_of(header, {});
  const std::uint32_t count = 1 << 24;
  std::string ledger = "LEDG";
  ledger.append(reinterpret_cast<const char*>(&count), 4);
  bytes.insert(bytes.size() - 112, ledger + "crc?");
  const long before = peak_memory();
  EXPECT_NE(fault_of(folder, bytes).find("1275068416 bytes should follow, 112 are left"), std::string::npos)
      << fault_of(folder, bytes);
  std::string block = load(kFiles + "refuse/block-count-beyond-end.photons");
  EXPECT_NE(fault_of(folder, block).find("2097152 bytes should follow"), std::string::npos);
  EXPECT_LT(peak_memory() - before, 4 << 20);
}

TEST(Photons, AcceptsEveryFileOfTheFolderAccept) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "accept")) {
    if (entry.path().extension() != ".photons") continue;
    EXPECT_NO_THROW(read_all(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 14);
}

TEST(Photons, RefusesEveryFileOfTheFolderRefuse) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "refuse")) {
    if (entry.path().filename() == "overlay-base.photons") continue;  // good: the others lie upon it
    EXPECT_THROW(read_all(entry.path()), InputError) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 80);
}

// 1e30 + 1 - 1e30 = 1 on paper, whatever the order and the blocks; a running float64 sum gives 0.
TEST(Photons, StoredFluxIsExactForAnyOrderAndCut) {
  Folder folder;
  PhotonHeader header;
  header.map = "dynamic";
  PhotonBlock block;
  for (float flux : {1e30f, 1.0f, -1e30f}) {
    block.photons.emplace_back();
    block.photons.back().flux = {flux, -flux, 2 * flux};
  }
  std::vector<PhotonBlock> single(3);
  for (int i = 0; i < 3; ++i) single[i].photons = {block.photons[(i + 1) % 3]};
  for (const std::string& bytes : {bytes_of(header, {block}), bytes_of(header, single)}) {
    save(folder / "a.photons", bytes);
    EXPECT_EQ(read_all(folder / "a.photons").totals.stored_flux, (std::array<double, 3>{1, -1, 2}));
  }
}

TEST(Photons, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto sink = [](const void*, std::size_t) {};
  const auto refused = [&](const PhotonBlock& block, const PhotonHeader& header = {}) {
    PhotonWriter writer(sink, header);
    EXPECT_THROW(writer.write(block), std::invalid_argument);
  };
  const auto of = [](Photon p) { return PhotonBlock{0, {Photon(), p}, {}, {}}; };
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  refused(of({.position = {0, nan, 0}}));
  refused(of({.flux = {inf, 0, 0}}));
  refused(of({.flux = {0, 0, -1}}));
  refused(of({.normal = {65535, 0}}));
  refused(of({.kind = PathKind::volume}));
  refused(of({.kind = PathKind(64)}));
  refused({1, {Photon()}, {}, {}});
  refused({0, {Photon()}, {{1, 2}}, {}});
  PhotonHeader bad;
  bad.kinds = "direct,";
  EXPECT_THROW(PhotonWriter(sink, bad), std::invalid_argument);
  bad = {};
  bad.history = "line\x1b[2J\n";
  EXPECT_THROW(PhotonWriter(sink, bad), std::invalid_argument);
  bad.history = "no line feed";
  EXPECT_THROW(PhotonWriter(sink, bad), std::invalid_argument);
  PhotonWriter writer(sink, {});
  PhotonTotals totals;
  totals.escaped_flux[1] = nan;
  EXPECT_THROW(writer.finish(totals), std::invalid_argument);
  EXPECT_THROW(writer.write_encoded("nonsense", {0, {Photon()}, {}, {}}), std::invalid_argument);
}

// For read_photons_test.sh: files and, per file, what the second reader must find.
TEST(Photons, FilesForTheSecondReader) {
  const char* name = std::getenv("TEMPOLUX_SECOND_READER");
  if (!name) GTEST_SKIP() << "only for read_photons_test.sh";
  const std::string folder = std::string(name) + "/";
  save(folder + "rich.photons", rich_bytes());
  save(folder + "plain.photons", bytes_of({}, {block_of(0, 70000, 0)}, {0, {}, {0.1, 0.2, 0.3}, {0, 1e-30, 0.7}, {}}));
  PhotonHeader dynamic;
  dynamic.map = "dynamic";
  PhotonBlock block = block_of(0, 1000, 0);
  for (Photon& p : block.photons) p.flux[p.bounce % 3] *= -1e6f;
  dynamic.identity = {"g1", "m1", "a1", "l1", "v1", 0, 0};
  dynamic.identity.emission = "e1";  // version 1.1
  save(folder + "dynamic.photons", bytes_of(dynamic, {block}));
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".photons") paths.push_back(entry.path());
  for (const std::string& path : paths) {
    const Contents all = read_all(path);
    std::ofstream out(path + ".expected");
    out.precision(17);
    out << all.photon_count();
    for (const auto& flux : {all.totals.stored_flux, all.totals.emitted_flux, all.totals.escaped_flux})
      for (double x : flux) out << ' ' << x;
    out << '\n';
  }
}

}  // namespace
}  // namespace tempolux::formats
