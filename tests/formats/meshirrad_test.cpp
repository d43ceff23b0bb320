// The .meshirrad format: the page's example, cells of triangles, what comes back, what is refused.
#include "formats/meshirrad/meshirrad.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

const std::string kFiles = "formats/meshirrad/";

MeshirradHeader header() {
  MeshirradHeader h;
  h.history = "example\n";
  h.identity.static_geometry = "a1";
  h.identity.first_frame = h.identity.last_frame = 3;
  h.cell = 0.5;
  h.unit = 0.25;
  return h;
}

MeshElement front() {
  MeshElement e;
  e.surface = 2;
  e.triangle = 5;
  e.position = {1, 2, 3};
  e.normal = {32767, 65534};
  e.area = 0.5f;
  e.photons = 3;
  e.sums = {4, 2, 1};
  e.irradiance = {2, 1, 0.5f};
  e.object = 7;
  return e;
}

MeshirradFile example() {
  MeshElement back = front();
  back.side = 1;
  back.normal = {32767, 32767};
  back.photons = 0;
  back.sums = {};
  back.irradiance = {};
  return {header(), {front(), back}};
}

/// Triangles of 1, 4, 9, ... cells, more than a block of them.
MeshirradFile rich() {
  MeshirradFile file{header(), {}};
  file.header.filter = "gaussian 0.125";
  for (std::uint32_t t = 0; t < 1500; ++t)
    for (std::uint32_t c = 0, n = t % 12 + 1; c < n * n; ++c) {
      MeshElement e = front();
      e.surface = t / 500;
      e.triangle = t % 500;
      e.cuts = std::uint16_t(n);
      e.cell = c;
      e.photons = c;
      file.elements.push_back(e);
    }
  return file;
}

std::string bytes_of(const MeshirradFile& file) {
  std::string bytes;
  write_meshirrad([&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                  file);
  return bytes;
}

/// Photons of the three frames before and of sixteen after.
MeshirradFile windows() {
  MeshirradFile file = example();
  file.header.holds = MeshHolds::windows;
  file.header.filter = "gaussian 0.25";
  file.elements[0].before = 3;
  file.elements[0].after = 16;
  return file;
}

MeshirradFile counts() {
  MeshirradFile file = example();
  file.header.holds = MeshHolds::counts;
  file.header.jump = true;
  file.elements[0].irradiance = {7.5f, 0, 0};
  return file;
}

void read(const std::string& path) { load_meshirrad(path); }

TEST(Meshirrad, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  const std::string bytes = bytes_of(example());
  EXPECT_EQ(bytes, worked_example("../formats/meshirrad/meshirrad.md"));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.meshirrad"));
  const MeshirradFile file = load_meshirrad(kFiles + "accept/worked-example.meshirrad");
  EXPECT_EQ(file.elements, example().elements);
  EXPECT_EQ(file.header.identity, header().identity);
  EXPECT_NE(load("../formats/meshirrad/meshirrad.md").find(digest_of(file)), std::string::npos) << digest_of(file);
}

TEST(Meshirrad, EverythingComesBack) {
  const Folder folder;
  save(folder / "a.meshirrad", bytes_of(rich()));
  const MeshirradFile a = load_meshirrad(folder / "a.meshirrad");
  EXPECT_EQ(a.elements, rich().elements);
  EXPECT_EQ(a.header.filter, "gaussian 0.125");
  EXPECT_EQ(digest_of(a), digest_of(rich()));
}

TEST(Meshirrad, CountsAndWindowsAreVersion1_1) {
  EXPECT_EQ(bytes_of(windows()), load(kFiles + "accept/windows.meshirrad"));
  EXPECT_EQ(bytes_of(counts()), load(kFiles + "accept/counts-after-a-jump.meshirrad"));
  const MeshirradFile file = load_meshirrad(kFiles + "accept/counts-after-a-jump.meshirrad");
  EXPECT_EQ(file.elements, counts().elements);
  EXPECT_EQ(file.elements[0].squares(), 7.5);
  EXPECT_EQ(file.header.holds, MeshHolds::counts);
  EXPECT_TRUE(file.header.jump);
  EXPECT_NE(digest_of(file), digest_of(example()));
}

/// Each cell holds its centre; a place lies in the cell whose centre is nearest in the sheared lattice: checked by
/// brute force on paper for n = 2: cells 0 (corner 0), 1 (middle, on its tip), 2 (corner 1), 3 (corner 2).
TEST(Meshirrad, CellsPartTheTriangle) {
  EXPECT_EQ(mesh_cell(2, 0.1f, 0.1f), 0u);
  EXPECT_EQ(mesh_cell(2, 0.4f, 0.4f), 1u);
  EXPECT_EQ(mesh_cell(2, 0.8f, 0.1f), 2u);
  EXPECT_EQ(mesh_cell(2, 0.1f, 0.8f), 3u);
  for (const std::uint32_t n : {1u, 2u, 3u, 17u, 1024u})
    for (std::uint32_t c = 0; c<n * n; c += n> 100 ? 997 : 1) {
      const auto [u, v] = mesh_cell_centre(n, c);
      EXPECT_GE(std::min(u, v), 0);
      EXPECT_LE(u + v, 1);
      EXPECT_EQ(mesh_cell(n, u, v), c) << n;
    }
  // Rounding may leave u + v a little above 1, and corners are of the last cells: no cell beyond the triangle.
  for (const std::uint32_t n : {1u, 5u, 1024u})
    for (const float u : {0.0f, 0.25f, 1.0f, 1.0000001f, -1e-7f}) EXPECT_LT(mesh_cell(n, u, 1.0000001f - u), n * n);
}

TEST(Meshirrad, EveryTruncationAndFlippedBitIsAnError) {
  expect_every_truncation_refused(bytes_of(example()), read);
  expect_every_flipped_bit_refused(bytes_of(example()), read);
}

TEST(Meshirrad, AcceptsAndRefusesTheFilesOfTheFolders) {
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "accept"))
    EXPECT_NO_THROW(load_meshirrad(entry.path())) << entry.path();
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "refuse"))
    EXPECT_THROW(load_meshirrad(entry.path()), InputError) << entry.path();
}

TEST(Meshirrad, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto refused = [](const auto& change) {
    MeshirradFile file = example();
    change(file);
    EXPECT_THROW(bytes_of(file), std::invalid_argument);
  };
  refused([](MeshirradFile& f) { f.elements[0].irradiance[1] = NAN; });
  refused([](MeshirradFile& f) { f.elements[0].cuts = 2; });
  refused([](MeshirradFile& f) { std::swap(f.elements[0], f.elements[1]); });
  refused([](MeshirradFile& f) { f.elements[1].sums[0] = -1; });
  refused([](MeshirradFile& f) { f.header.unit = 0; });
  refused([](MeshirradFile& f) { f.header.filter = "box"; });
  refused([](MeshirradFile& f) { f.elements[0].after = 1; });
  refused([](MeshirradFile& f) { f.header.jump = true; });
  refused([](MeshirradFile& f) { f.header.holds = MeshHolds::counts, f.header.filter = "box 1"; });
}

TEST(Meshirrad, FilesForTheSecondReader) {
  const char* name = std::getenv("TEMPOLUX_SECOND_READER");
  if (!name) GTEST_SKIP() << "only for read_totals_test.sh";
  const std::string folder = std::string(name) + "/";
  save(folder + "rich.meshirrad", bytes_of(rich()));
  save(folder + "plain.meshirrad", bytes_of(example()));
  save(folder + "windows.meshirrad", bytes_of(windows()));
  std::ofstream(folder + "windows.meshirrad.expected") << 2 << '\n';
  std::ofstream(folder + "rich.meshirrad.expected") << rich().elements.size() << '\n';
  std::ofstream(folder + "plain.meshirrad.expected") << 2 << '\n';
}

}  // namespace
}  // namespace tempolux::formats
