#include <gtest/gtest.h>

#include "tests/formats/photons_files.h"

namespace tempolux::formats {
namespace {

using namespace testing;

PhotonHeader header_of(std::uint32_t groups, std::uint32_t columns = 0) {
  PhotonHeader header;
  header.group_count = groups;
  header.columns = columns;
  return header;
}

/// A base of groups 0, 1, 2, 4 (of 6), and an overlay that replaces 1, empties 2, adds 3 and 5.
class Overlay : public ::testing::Test {
 protected:
  static constexpr std::uint32_t columns = column_direction;
  Folder folder;
  std::string base_path = folder / "base.photons", path = folder / "overlay.photons";
  PhotonBlock g0 = block_of(0, 5, columns), g1 = block_of(1, 6, columns), g2 = block_of(2, 7, columns),
              g4 = block_of(4, 8, columns);
  PhotonBlock new1 = block_of(1, 9, columns, 50), new3 = block_of(3, 2, columns), new5 = block_of(5, 1, columns);
  PhotonBlock none2{2, {}, {}, {}};
  std::vector<GroupFlux> new_ledger = ledger_of({1, 2, 3, 5}, 7);

  void SetUp() override {
    save(base_path, bytes_of(header_of(6, columns), {g0, g1, g2, g4}, {}, ledger_of({0, 1, 2, 3, 4, 5})));
    save(path, bytes_of(overlay_header(), {new1, none2, new3, new5}, {}, new_ledger));
  }
  PhotonHeader overlay_header() {
    PhotonHeader header = header_of(6, columns);
    header.base_name = "base.photons";
    header.base_digest = read_all(base_path).digest;
    header.emitted_count = 99;
    return header;
  }
};

TEST_F(Overlay, WithItsBaseIsTheMapWrittenWhole) {
  std::vector<GroupFlux> ledger = ledger_of({0, 1, 2, 3, 4, 5});
  for (const GroupFlux& group : new_ledger) ledger[group.group] = group;
  save(folder / "whole.photons", bytes_of(header_of(6, columns), {g0, new1, new3, g4, new5}, {}, ledger));
  const Contents merged = read_all(path), whole = read_all(folder / "whole.photons");
  ASSERT_EQ(merged.groups.size(), whole.groups.size());
  for (std::size_t i = 0; i < whole.groups.size(); ++i) {
    EXPECT_EQ(merged.groups[i].group, whole.groups[i].group);
    EXPECT_EQ(merged.groups[i].photons, whole.groups[i].photons);
    EXPECT_EQ(merged.groups[i].directions, whole.groups[i].directions);
  }
  EXPECT_EQ(merged.totals, whole.totals);
  EXPECT_EQ(merged.ledger, whole.ledger);
  EXPECT_EQ(merged.digest, whole.digest);
  EXPECT_EQ(merged.header.emitted_count, 99u);
  EXPECT_EQ(load_photons(path).photons, load_photons(folder / "whole.photons").photons);
}

TEST_F(Overlay, OfNothingIsItsBase) {
  save(path, bytes_of(overlay_header(), {}));
  EXPECT_EQ(read_all(path).digest, read_all(base_path).digest);
  EXPECT_EQ(read_all(path).totals, read_all(base_path).totals);
}

TEST_F(Overlay, OfAllGroupsHidesItsBase) {
  std::vector<PhotonBlock> blocks;
  for (std::uint32_t g = 0; g < 6; ++g) blocks.push_back({g, {}, {}, {}});
  save(path, bytes_of(overlay_header(), blocks, {}, ledger_of({0, 1, 2, 3, 4, 5})));
  EXPECT_EQ(read_all(path).photon_count(), 0u);
}

TEST_F(Overlay, OfAChangedBaseIsRefused) {
  g4.photons[0].bounce ^= 1;
  save(base_path, bytes_of(header_of(6, columns), {g0, g1, g2, g4}, {}, ledger_of({0, 1, 2, 3, 4, 5})));
  EXPECT_THROW(read_all(path), InputError);
}

TEST_F(Overlay, OfABaseWithoutLedgerIsRefused) {
  save(base_path, bytes_of(header_of(6, columns), {g0, g1, g2, g4}));
  EXPECT_THROW(read_all(path), InputError);
}

TEST_F(Overlay, IsNotWrittenWithoutTheLedgerOfItsGroups) {
  EXPECT_THROW(bytes_of(overlay_header(), {new1}), std::invalid_argument);
  EXPECT_THROW(bytes_of(overlay_header(), {new1}, {}, ledger_of({2})), std::invalid_argument);
}

std::string digest_of(const PhotonHeader& header, const std::vector<PhotonBlock>& blocks) {
  Folder folder;
  save(folder / "a.photons", bytes_of(header, blocks));
  return read_all(folder / "a.photons").digest;
}

TEST(PhotonsDigest, DoesNotDependOnBlocksHeaderOrTotals) {
  constexpr std::uint32_t columns = column_direction | column_albedo;
  const PhotonHeader plain = header_of(3, columns);
  const std::string expected = digest_of(plain, {block_of(1, 100, columns), block_of(2, 5, columns)});
  EXPECT_EQ(digest_of(plain, {block_of(1, 30, columns), block_of(1, 70, columns, 30), block_of(2, 5, columns)}),
            expected);
  PhotonHeader other = plain;
  other.history = "1.0 somebody\n";
  other.identity = {"g", "m", "a", "l", "v", 3, 4};
  other.emitted_count = 77;
  other.kinds = "indirect,direct,caustic,volume";
  EXPECT_EQ(digest_of(other, {block_of(1, 100, columns), block_of(2, 5, columns)}), expected);
}

TEST(PhotonsDigest, DependsOnEverythingElse) {
  const std::vector<PhotonBlock> blocks{block_of(0, 3, 0), block_of(1, 3, 0)};
  const std::string digest = digest_of(header_of(2), blocks);
  EXPECT_NE(digest_of(header_of(3), blocks), digest);
  PhotonHeader moved = header_of(2), still = header_of(2);
  moved.origin[2] = 1;
  still.map = "static";
  EXPECT_NE(digest_of(moved, blocks), digest);
  EXPECT_NE(digest_of(still, blocks), digest);
  auto changed = blocks;
  changed[1].photons[2].bounce ^= 1;
  EXPECT_NE(digest_of(header_of(2), changed), digest);
  auto swapped = blocks;
  std::swap(swapped[0].photons[0], swapped[0].photons[1]);
  EXPECT_NE(digest_of(header_of(2), swapped), digest);
  auto regrouped = blocks;  // the same photons in the same order, the border between groups elsewhere
  regrouped[0].photons.push_back(regrouped[1].photons.front());
  regrouped[1].photons.erase(regrouped[1].photons.begin());
  EXPECT_NE(digest_of(header_of(2), regrouped), digest);
}

}  // namespace
}  // namespace tempolux::formats
