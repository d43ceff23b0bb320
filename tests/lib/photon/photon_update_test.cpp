// Selective photon tracing: an update of all groups is a fresh map, one of none is the old one, and overlays say the same as whole files.
#include "lib/photon/photon_update.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <numeric>

#include "tests/support/closed_box.h"
#include "tests/support/media.h"

namespace tempolux {
namespace {

/// A room with smoke of two states under common majorants, and maps of it in a folder of their own.
class PhotonUpdate : public testing::Test {
 protected:
  PhotonUpdate() : folder_(std::filesystem::temp_directory_path() / ("photon_update_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    options_.photon_count = 6300;
    options_.group_count = 63;
    options_.store_volume = true;
  }
  ~PhotonUpdate() override { std::filesystem::remove_all(folder_); }

  /// The room with this extinction, majorants of 2 / m.
  struct Room {
    test::ClosedBox box{test::Shape::cube, 0.5f};
    std::unique_ptr<Tracer> tracer;
    std::unique_ptr<Lights> lights;
    std::unique_ptr<PhotonTracer> photons;
    Room(float sigma, const PhotonOptions& options) {
      const MediumOptions medium{.sigma_t = sigma, .albedo = Rgb(0.7f)};
      const auto own = test::cube_of_medium({}, 1.2, medium);
      const MajorantGrid frozen = test::cube_of_medium({}, 1.2, {.sigma_t = 2})->majorants();
      box.scene.set_media(std::make_shared<const Media>(std::vector<Medium>(own->all().begin(), own->all().end()), frozen));
      tracer = std::make_unique<Tracer>(box.scene.frame());
      lights = std::make_unique<Lights>(box.scene.frame(), box.table);
      photons = std::make_unique<PhotonTracer>(*tracer, *lights, options);
    }
  };
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  formats::PhotonHeader header(int frame) const {
    formats::PhotonHeader h;
    h.identity.first_frame = h.identity.last_frame = frame;
    return h;
  }
  template <class Write>
  std::string written(const std::string& name, const Write& write) const {
    std::FILE* file = std::fopen(path(name).c_str(), "wb");
    write([&](const void* data, std::size_t size) { ASSERT_EQ(std::fwrite(data, 1, size, file), size); });
    std::fclose(file);
    formats::PhotonReader reader(path(name));
    formats::PhotonBlock block;
    while (reader.read_block(block)) {}
    return reader.digest();
  }
  std::string fresh(const std::string& name, const Room& room, int frame) const {
    return written(name, [&](const auto& sink) { write_photon_map(*room.photons, options_, header(frame), sink, {}); });
  }
  std::string updated(const std::string& name, const std::string& from, const Room& room, int frame, const UpdateOptions& how, bool same = false) {
    const PreviousMap previous = read_previous(path(from), *room.photons, how.strategy == UpdateStrategy::census, {});
    groups_ = choose_groups(previous, frame, same, how);
    return written(name, [&](const auto& sink) {
      write_updated_map(*room.photons, options_, header(frame), path(from), previous, groups_, true, sink);
    });
  }
  bool is_overlay(const std::string& name) const { return !formats::PhotonReader(path(name)).header().base_name.empty(); }

  std::filesystem::path folder_;
  PhotonOptions options_;
  std::vector<std::uint32_t> groups_;
};

TEST_F(PhotonUpdate, OfAllGroupsIsAFreshMapOfNoneTheOld) {
  const Room thin(0.5f, options_), thick(2, options_);
  const std::string old = fresh("0.photons", thin, 0), wanted = fresh("new.photons", thick, 1);
  EXPECT_NE(old, wanted);
  EXPECT_EQ(updated("1.photons", "0.photons", thick, 1, {UpdateStrategy::all, 0, 0}), wanted);
  EXPECT_FALSE(is_overlay("1.photons"));
  EXPECT_EQ(updated("still.photons", "0.photons", thin, 1, {UpdateStrategy::oldest, 20, 0}, true), old);
  EXPECT_TRUE(groups_.empty());
  EXPECT_TRUE(is_overlay("still.photons"));
  EXPECT_LT(std::filesystem::file_size(path("still.photons")), 1000u);
}

/// A third of the groups at each of three frames: each group once, so that the third map is a fresh one; the first is an overlay, the second
/// differs in more than half of its groups and is whole.
TEST_F(PhotonUpdate, OldestFirstGoesRoundOnce) {
  const Room thin(0.5f, options_), thick(2, options_);
  fresh("0.photons", thin, 0);
  const std::string wanted = fresh("new.photons", thick, 9);
  const UpdateOptions oldest{UpdateStrategy::oldest, 21, 0};
  updated("1.photons", "0.photons", thick, 1, oldest);
  EXPECT_EQ(groups_.size(), 21u);
  EXPECT_TRUE(is_overlay("1.photons"));
  const auto first = groups_;
  updated("2.photons", "1.photons", thick, 2, oldest);
  EXPECT_FALSE(is_overlay("2.photons"));
  for (const std::uint32_t g : groups_) EXPECT_EQ(std::ranges::count(first, g), 0);
  EXPECT_EQ(updated("3.photons", "2.photons", thick, 3, oldest), wanted);
  formats::PhotonReader reader(path("3.photons"));
  formats::PhotonBlock block;
  while (reader.read_block(block)) {}
  for (const formats::GroupFlux& group : reader.ledger()) {
    EXPECT_GE(group.frame, 1);
    EXPECT_EQ(group.paths, 100u);
  }
}

TEST_F(PhotonUpdate, OverlayUponOverlayKeepsItsBase) {
  const Room thin(0.5f, options_), thick(2, options_);
  fresh("0.photons", thin, 0);
  const UpdateOptions few{UpdateStrategy::random, 10, 0};
  updated("1.photons", "0.photons", thick, 1, few);
  const auto first = groups_;
  const std::string two = updated("2.photons", "1.photons", thick, 2, few);
  ASSERT_TRUE(is_overlay("2.photons"));
  EXPECT_EQ(formats::PhotonReader(path("2.photons")).header().base_name, "0.photons");
  // The same written whole, which is not possible in another folder's name.
  const PreviousMap previous = read_previous(path("1.photons"), *thick.photons, false, {});
  const std::string whole = written("whole.photons", [&](const auto& sink) {
    write_updated_map(*thick.photons, options_, header(2), path("1.photons"), previous, groups_, false, sink);
  });
  EXPECT_EQ(whole, two);
}

TEST_F(PhotonUpdate, CensusSeesChangeAndOnlyThat) {
  const Room thin(0.5f, options_), thick(2, options_);
  fresh("0.photons", thin, 0);
  const PreviousMap none = read_previous(path("0.photons"), *thin.photons, true, {});
  const PreviousMap much = read_previous(path("0.photons"), *thick.photons, true, {});
  const double still = std::accumulate(none.change.begin(), none.change.end(), 0.0);
  const double sum = std::accumulate(much.change.begin(), much.change.end(), 0.0);
  // Extinction is kept to 1/65534 of the majorant: the rest of what did not change is below 1e-4 of what did.
  EXPECT_LT(still, 1e-4 * sum);
  // Four times the extinction: the change is three times what collided.
  double collided = 0;
  formats::PhotonReader reader(path("0.photons"));
  formats::PhotonBlock block;
  while (reader.read_block(block))
    for (const formats::Photon& p : block.photons)
      if (p.kind == formats::PathKind::tentative)
        collided += double((p.flux[0] + p.flux[1] + p.flux[2]) / 3 * thin.tracer->frame().media->extinction({p.position[0], p.position[1], p.position[2]}));
  EXPECT_NEAR(sum, 3 * collided, 0.003 * sum);
  updated("1.photons", "0.photons", thick, 1, {UpdateStrategy::census, 5, 0});
  ASSERT_EQ(groups_.size(), 5u);
  for (const std::uint32_t g : groups_)
    EXPECT_GE(much.change[g], [&] { auto sorted = much.change; std::ranges::sort(sorted, std::greater<>()); return sorted[4]; }());
}

TEST_F(PhotonUpdate, RefusesMapsOfOtherPaths) {
  const Room thin(0.5f, options_);
  formats::PhotonHeader a = header(0);
  a.kinds = "tentative";
  a.majorants = std::string(32, '0');
  formats::PhotonHeader b = a;
  EXPECT_EQ(why_not_updatable(a, b), "");
  b.emitted_count = 7;
  EXPECT_NE(why_not_updatable(a, b), "");
  b = a;
  b.majorants = std::string(32, '1');
  EXPECT_NE(why_not_updatable(a, b).find("majorants"), std::string::npos);
  b = a;
  b.identity.emission = "other";
  EXPECT_NE(why_not_updatable(a, b), "");
}

}  // namespace
}  // namespace tempolux
