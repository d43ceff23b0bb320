// The .paths format: the page's example, what comes back, what is refused.
#include "formats/paths/paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/formats/files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

const std::string kFiles = "formats/paths/";

PathsHeader header() {
  PathsHeader h;
  h.history = "example\n";
  h.identity = {"a1", "", "b2", "c3", "", 0, 23};
  h.identity.emission = "d4";
  h.group_count = 2;
  h.emitted_count = 8;
  h.seed = 3;
  h.kinds = "direct,indirect";
  h.movers = {"a1", "b2", "c3"};
  return h;
}

std::string bytes_of(const PathsHeader& h, const std::vector<std::vector<TouchedPath>>& calls) {
  std::string bytes;
  PathsWriter writer([&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                     h);
  for (const auto& paths : calls) writer.write(paths);
  writer.finish();
  return bytes;
}

const std::vector<TouchedPath> kExample{{4, 1}, {1, 6}, {7, 4}};

/// Many paths: every third of 2^20 in 7 groups, in 64 intervals.
PathsHeader rich_header() {
  PathsHeader h = header();
  h.identity.last_frame = 99;
  h.group_count = 7;
  h.emitted_count = 1 << 20;
  h.movers.assign(64, "m");
  return h;
}
std::vector<TouchedPath> rich_paths() {
  std::vector<TouchedPath> paths;
  for (std::uint64_t g = 0; g < 7; ++g)
    for (std::uint64_t p = g; p < (1 << 20); p += 21) paths.push_back({p, p * 0x9e3779b97f4a7c15ull | 1});
  return paths;
}

void read(const std::string& path) { load_paths(path); }

TEST(Paths, WorkedExampleOfThePageIsWhatTheWriterWrites) {
  const std::string bytes = bytes_of(header(), {kExample});
  EXPECT_EQ(bytes, worked_example("../formats/paths/paths.md"));
  EXPECT_EQ(bytes, load(kFiles + "accept/worked-example.paths"));
  const PathsFile file = load_paths(kFiles + "accept/worked-example.paths");
  EXPECT_EQ(file.paths, kExample);
  EXPECT_EQ(file.header.seed, 3u);
  EXPECT_EQ(file.header.movers, header().movers);
  EXPECT_EQ(file.header.identity, header().identity);
  EXPECT_NE(load("../formats/paths/paths.md").find(digest_of(file)), std::string::npos) << digest_of(file);
}

TEST(Paths, EverythingComesBackHoweverItIsCut) {
  const Folder folder;
  const std::vector<TouchedPath> paths = rich_paths();
  const std::size_t half = paths.size() / 2;
  save(folder / "a.paths", bytes_of(rich_header(), {paths}));
  save(folder / "b.paths", bytes_of(rich_header(), {{paths.begin(), paths.begin() + std::ptrdiff_t(half)},
                                                    {paths.begin() + std::ptrdiff_t(half), paths.end()}}));
  const PathsFile a = load_paths(folder / "a.paths"), b = load_paths(folder / "b.paths");
  EXPECT_EQ(a.paths, paths);
  EXPECT_EQ(b.paths, paths);
  EXPECT_EQ(digest_of(a), digest_of(b));
}

TEST(Paths, EveryTruncationAndFlippedBitIsAnError) {
  expect_every_truncation_refused(bytes_of(header(), {kExample}), read);
  expect_every_flipped_bit_refused(bytes_of(header(), {kExample}), read);
}

TEST(Paths, AcceptsAndRefusesTheFilesOfTheFolders) {
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "accept"))
    EXPECT_NO_THROW(load_paths(entry.path())) << entry.path();
  for (const auto& entry : std::filesystem::directory_iterator(kFiles + "refuse"))
    EXPECT_THROW(load_paths(entry.path()), InputError) << entry.path();
}

TEST(Paths, TheWriterWritesNothingThatAReaderWouldRefuse) {
  const auto refused = [](const PathsHeader& h, const std::vector<TouchedPath>& paths) {
    EXPECT_THROW(bytes_of(h, {paths}), std::invalid_argument);
  };
  refused(header(), {{8, 1}});
  refused(header(), {{1, 0}});
  refused(header(), {{1, 8}});
  refused(header(), {{1, 1}, {0, 1}});
  refused(header(), {{1, 1}, {1, 1}});
  PathsHeader bad = header();
  bad.movers.clear();
  refused(bad, {});
  bad = header();
  bad.identity = {};
  refused(bad, {});
}

TEST(Paths, IntervalsDivideTheSegment) {
  for (int f = 24; f <= 47; ++f) EXPECT_EQ(interval_of(f, 24, 47, 24), std::size_t(f - 24));
  EXPECT_EQ(interval_of(0, 0, 99, 64), 0u);
  EXPECT_EQ(interval_of(1, 0, 99, 64), 0u);
  EXPECT_EQ(interval_of(2, 0, 99, 64), 1u);
  EXPECT_EQ(interval_of(99, 0, 99, 64), 63u);
  EXPECT_EQ(interval_of(-3, -24, -1, 24), 21u);
}

TEST(Paths, FilesForTheSecondReader) {
  const char* name = std::getenv("TEMPOLUX_SECOND_READER");
  if (!name) GTEST_SKIP() << "only for read_totals_test.sh";
  const std::string folder = std::string(name) + "/";
  save(folder + "rich.paths", bytes_of(rich_header(), {rich_paths()}));
  save(folder + "plain.paths", bytes_of(header(), {kExample}));
  std::ofstream(folder + "rich.paths.expected") << rich_paths().size() << '\n';
  std::ofstream(folder + "plain.paths.expected") << kExample.size() << '\n';
}

}  // namespace
}  // namespace tempolux::formats
