// The .lightgrid format: the page's example, what comes back, what is refused.
#include "formats/lightgrid/lightgrid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

const std::string kFiles = "formats/lightgrid/";

LightgridFile example() {
  LightgridFile file;
  file.header.history = "example\n";
  file.header.identity.static_geometry = "a1";
  file.header.identity.first_frame = file.header.identity.last_frame = 3;
  file.header.edge = 0.5;
  file.header.parts = {2, 1};
  file.cells = {{{-1, 2, 3}, 2, 0.5f, 0.25f, {0.25f, 1}}, {{-1, 2, 3}, 5, 0, 1, {1, 1}}};
  return file;
}

/// More than a block of cells, as many parts as frame-render has.
LightgridFile rich() {
  LightgridFile file = example();
  file.header.parts = {32, 16};
  file.cells.clear();
  for (int i = 0; i < 1100; ++i) {
    LightgridCell cell{{i / 100, i / 10 % 10, i % 10}, std::uint32_t(i % 6), float(i % 3) / 4, 0.25f, {}};
    for (int k = 1; k <= 512; ++k) cell.end.push_back(float(k) / 512);
    file.cells.push_back(cell);
  }
  return file;
}

std::string bytes_of(const LightgridFile& file) {
  std::string bytes;
  write_lightgrid([&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                  file);
  return bytes;
}

void read(const std::string& path) { load_lightgrid(path); }

TEST(Lightgrid, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  const std::string bytes = bytes_of(example());
  EXPECT_EQ(bytes, worked_example("../formats/lightgrid/lightgrid.md"));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.lightgrid"));
  const LightgridFile file = load_lightgrid(kFiles + "accept/worked-example.lightgrid");
  EXPECT_EQ(file.cells, example().cells);
  EXPECT_EQ(file.header.identity, example().header.identity);
  EXPECT_NE(load("../formats/lightgrid/lightgrid.md").find(digest_of(file)), std::string::npos) << digest_of(file);
}

TEST(Lightgrid, EverythingComesBack) {
  const Folder folder;
  save(folder / "a.lightgrid", bytes_of(rich()));
  const LightgridFile a = load_lightgrid(folder / "a.lightgrid");
  EXPECT_EQ(a.cells, rich().cells);
  EXPECT_EQ(a.header.parts, rich().header.parts);
  EXPECT_EQ(digest_of(a), digest_of(rich()));
  EXPECT_NE(digest_of(a), digest_of(example()));
}

TEST(Lightgrid, EveryTruncationAndFlippedBitIsAnError) {
  expect_every_truncation_refused(bytes_of(example()), read);
  expect_every_flipped_bit_refused(bytes_of(example()), read);
}

TEST(Lightgrid, AcceptsAndRefusesTheFilesOfTheFolders) {
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "accept"))
    EXPECT_NO_THROW(load_lightgrid(entry.path())) << entry.path();
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "refuse"))
    EXPECT_THROW(load_lightgrid(entry.path()), InputError) << entry.path();
}

TEST(Lightgrid, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto refused = [](const auto& change) {
    LightgridFile file = example();
    change(file);
    EXPECT_THROW(bytes_of(file), std::invalid_argument);
  };
  refused([](LightgridFile& f) { f.cells[0].sky = NAN; });
  refused([](LightgridFile& f) { f.cells[0].sky = 0.8f; });
  refused([](LightgridFile& f) { f.cells[0].facing = 6; });
  refused([](LightgridFile& f) { f.cells[0].end.pop_back(); });
  refused([](LightgridFile& f) { f.cells[0].end[1] = 0.99f; });
  refused([](LightgridFile& f) { std::swap(f.cells[0], f.cells[1]); });
  refused([](LightgridFile& f) { f.header.parts = {3, 1}; });
  refused([](LightgridFile& f) { f.header.edge = 0; });
}

TEST(Lightgrid, FilesForTheSecondReader) {
  const char* name = std::getenv("TEMPOLUX_SECOND_READER");
  if (!name) GTEST_SKIP() << "only for read_totals_test.sh";
  const std::string folder = std::string(name) + "/";
  save(folder + "rich.lightgrid", bytes_of(rich()));
  save(folder + "plain.lightgrid", bytes_of(example()));
  std::ofstream(folder + "rich.lightgrid.expected") << rich().cells.size() << '\n';
  std::ofstream(folder + "plain.lightgrid.expected") << 2 << '\n';
}

}  // namespace
}  // namespace tempolux::formats
