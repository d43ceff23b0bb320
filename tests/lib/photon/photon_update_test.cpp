// Selective photon tracing: an update of all groups equals a new map, an update of none equals the old one, and
// overlays equal whole files.
#include "lib/photon/photon_update.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <numeric>

#include "formats/error.h"
#include "lib/photon/photon_refine.h"
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
      box.scene.set_media(
          std::make_shared<const Media>(std::vector<Medium>(own->all().begin(), own->all().end()), frozen));
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
    return written(name, [&](const auto& sink) { write_photon_map(*room.photons, header(frame), sink, {}); });
  }
  std::string updated(const std::string& name, const std::string& from, const Room& room, int frame,
                      const UpdateOptions& how, bool same = false) {
    PreviousMap previous = read_previous(path(from), *room.photons, how.strategy, {});
    groups_ = choose_groups(previous, frame, same, how);
    return written(name, [&](const auto& sink) {
      write_updated_map(*room.photons, header(frame), {path(from), previous, groups_, true}, sink);
    });
  }
  bool is_overlay(const std::string& name) const {
    return !formats::PhotonReader(path(name)).header().base_name.empty();
  }

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

/// Three frames update a third of the groups each, so that each group is updated once and the third map equals a new
/// one. The first is an overlay; the second differs in more than half of its groups and is whole.
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
  // The same map, written as a whole file.
  PreviousMap previous = read_previous(path("1.photons"), *thick.photons, UpdateStrategy::oldest, {});
  const std::string whole = written("whole.photons", [&](const auto& sink) {
    write_updated_map(*thick.photons, header(2), {path("1.photons"), previous, groups_, false}, sink);
  });
  EXPECT_EQ(whole, two);
}

/// A map kept in memory from frame to frame produces the same files as a map that is read in each frame, priorities
/// included: overlays on overlays until more than half of the groups differ; then a whole map is written, which has to
/// be read again.
TEST_F(PhotonUpdate, KeptMapMakesTheSameFiles) {
  const Room thin(0.5f, options_), thick(2, options_);
  fresh("0.photons", thin, 0);
  std::filesystem::create_directory(folder_ / "kept");
  std::filesystem::copy_file(path("0.photons"), path("kept/0.photons"));
  PreviousMap kept = read_previous(path("kept/0.photons"), *thick.photons, UpdateStrategy::census, {}, true);
  for (int frame = 1; frame <= 4; ++frame) {
    const UpdateOptions how{frame % 2 ? UpdateStrategy::census : UpdateStrategy::oldest, 12, 0};
    const Room& room = frame % 2 ? thick : thin;
    const std::string name = std::to_string(frame) + ".photons",
                      before = path("kept/" + std::to_string(frame - 1) + ".photons");
    ASSERT_EQ(kept.is_kept(), frame < 4) << frame;  // 36 of 63 groups differ at frame 3
    if (!kept.is_kept()) kept = read_previous(before, *room.photons, how.strategy, {}, true);
    find_change(before, kept, *room.photons, how.strategy, {});
    const std::string wanted = updated(name, std::to_string(frame - 1) + ".photons", room, frame, how);
    const PreviousMap read = read_previous(before, *room.photons, how.strategy, {});
    ASSERT_EQ(kept.change, read.change) << frame;
    ASSERT_EQ(kept.ledger, read.ledger) << frame;
    ASSERT_EQ(choose_groups(kept, frame, false, how), groups_);
    EXPECT_EQ(written("kept/" + name,
                      [&](const auto& sink) {
                        write_updated_map(*room.photons, header(frame), {before, kept, groups_, true}, sink);
                      }),
              wanted)
        << frame;
    EXPECT_EQ(is_overlay("kept/" + name), is_overlay(name)) << frame;
    EXPECT_EQ(std::filesystem::file_size(path("kept/" + name)), std::filesystem::file_size(path(name))) << frame;
  }
}

TEST_F(PhotonUpdate, CensusSeesChangeAndOnlyThat) {
  const Room thin(0.5f, options_), thick(2, options_);
  fresh("0.photons", thin, 0);
  const PreviousMap none = read_previous(path("0.photons"), *thin.photons, UpdateStrategy::census, {});
  const PreviousMap much = read_previous(path("0.photons"), *thick.photons, UpdateStrategy::census, {});
  const double still = std::accumulate(none.change.begin(), none.change.end(), 0.0);
  const double sum = std::accumulate(much.change.begin(), much.change.end(), 0.0);
  // Extinction is stored to 1/65534 of the majorant, so unchanged places differ by less than 1e-4 of the changed
  // ones.
  EXPECT_LT(still, 1e-4 * sum);
  // Four times the extinction: the change is three times what collided.
  double collided = 0;
  formats::PhotonReader reader(path("0.photons"));
  formats::PhotonBlock block;
  while (reader.read_block(block))
    for (const formats::Photon& p : block.photons)
      if (p.kind == formats::PathKind::tentative)
        collided += double((p.flux[0] + p.flux[1] + p.flux[2]) / 3 *
                           thin.tracer->frame().media->extinction({p.position[0], p.position[1], p.position[2]}));
  EXPECT_NEAR(sum, 3 * collided, 0.003 * sum);
  updated("1.photons", "0.photons", thick, 1, {UpdateStrategy::census, 5, 0});
  ASSERT_EQ(groups_.size(), 5u);
  for (const std::uint32_t g : groups_)
    EXPECT_GE(much.change[g], [&] {
      auto sorted = much.change;
      std::ranges::sort(sorted, std::greater<>());
      return sorted[4];
    }());
}

/// Pilots are paths of the map: their signatures do not change the map, and traced again through the same smoke they
/// have equal signatures.
TEST_F(PhotonUpdate, PilotsTellWhatHasChanged) {
  PhotonOptions plain = options_;
  options_.pilots = 7;
  const Room thin(0.5f, options_), same(0.5f, options_), thick(2, options_), unwatched(0.5f, plain);
  const std::string watched = fresh("0.photons", thin, 0);
  options_.pilots = 0;
  EXPECT_EQ(watched, fresh("plain.photons", unwatched, 0));
  EXPECT_THROW(read_previous(path("plain.photons"), *thick.photons, UpdateStrategy::fde, {}), InputError);
  const auto change = [&](const Room& room, UpdateStrategy strategy) {
    return read_previous(path("0.photons"), *room.photons, strategy, {}).change;
  };
  for (const auto strategy : {UpdateStrategy::fde, UpdateStrategy::dip, UpdateStrategy::hybrid, UpdateStrategy::path})
    for (const double c : change(same, strategy)) EXPECT_EQ(c, 0);
  // If smoke has changed everywhere, each pilot that passes smoke detects it, and some pilots scatter at other places;
  // a pilot that scatters elsewhere has passed smoke. With static surfaces, paths differ only by smoke.
  const auto fde = change(thick, UpdateStrategy::fde), dip = change(thick, UpdateStrategy::dip),
             way = change(thick, UpdateStrategy::path);
  double looked = 0, moved = 0;
  for (std::size_t g = 0; g < fde.size(); ++g) {
    EXPECT_LE(dip[g], fde[g]);
    EXPECT_EQ(dip[g], way[g]);
    looked += fde[g];
    moved += dip[g];
  }
  EXPECT_GT(moved, 0.1 * looked);
  EXPECT_LT(moved, 0.9 * looked);
}

/// The sketch: E[(difference)^2] = sum of squares of flux x change of extinction / majorant over the places.
TEST_F(PhotonUpdate, SketchesGiveTheChangeInTheMean) {
  options_.pilots = 100;
  const Room thin(0.5f, options_), more(0.501f, options_);
  double difference = 0, wanted = 0;
  for (std::uint32_t g = 0; g < 63; ++g) {
    const PhotonBatch a = thin.photons->trace_members(g, 0, 100), b = more.photons->trace_members(g, 0, 100);
    for (std::size_t q = 0; q < 100; ++q)
      if (a.pilots[q].collisions == b.pilots[q].collisions && a.pilots[q].vertices == b.pilots[q].vertices)
        difference += std::pow(a.pilots[q].sketch - b.pilots[q].sketch, 2);
    for (const PhotonBatch* batch : {&a, &b})  // few places are of paths that differ: 1 in 2000
      for (const formats::Photon& p : batch->block.photons) {
        if (p.kind != formats::PathKind::tentative) continue;
        const Vec3 at{p.position[0], p.position[1], p.position[2]};
        const double change =
            double(more.photons->media()->extinction(at)) - double(thin.photons->media()->extinction(at));
        const double share = double(options_.volume_share),
                     flux_per_majorant = share * double(p.flux[0] + p.flux[1] + p.flux[2]) / 3;
        wanted += 0.5 / share * std::pow(change * flux_per_majorant, 2);
      }
  }
  // 63 x 100 pilots of some ten places each: the mean of their squares is known to 3 %.
  EXPECT_NEAR(difference / wanted, 1, 0.1);
}

TEST(SpreadPaths, AddsUpAndGoesWhereVarianceFallsMost) {
  // On paper: moments 4 and 1, ten paths each; 10 more: 20 and 10 are in proportion to 2 and 1.
  EXPECT_EQ(spread_paths(std::vector<double>{4, 1}, std::vector<std::uint64_t>{10, 10}, 10),
            (std::vector<std::uint64_t>{20, 10}));
  // 14 paths in proportion to 2 and 1 would remove paths from the second group, so the first gets all new paths.
  EXPECT_EQ(spread_paths(std::vector<double>{4, 1, 0}, std::vector<std::uint64_t>{2, 10, 2}, 2),
            (std::vector<std::uint64_t>{4, 10, 2}));
  EXPECT_EQ(spread_paths(std::vector<double>{0, 0}, std::vector<std::uint64_t>{3, 4}, 3),
            (std::vector<std::uint64_t>{5, 5}));
  EXPECT_EQ(spread_paths(std::vector<double>{1, 1, 1}, std::vector<std::uint64_t>{5, 5, 5}, 2),
            (std::vector<std::uint64_t>{6, 6, 5}));
}

/// Many further paths in some groups change no mean: the emitted flux stays to the last digits, and the light in the
/// smoke within its noise.
TEST_F(PhotonUpdate, RefinedMapsKeepTheirFlux) {
  const Room thick(2, options_);
  fresh("0.photons", thick, 0);
  GroupMoments groups = read_moments(path("0.photons"), *thick.photons);
  for (std::size_t g = 0; g < groups.moments.size(); ++g) groups.moments[g] = g % 5 == 0 ? 1 : 0;
  written("1.photons", [&](const auto& sink) {
    write_refined_map(*thick.photons, header(0), path("0.photons"), groups, 13000, sink);
  });
  const auto totals = [&](const std::string& name) {
    formats::PhotonReader reader(path(name));
    formats::PhotonBlock block;
    double worth = 0;
    while (reader.read_block(block))
      for (const formats::Photon& p : block.photons)
        worth += p.kind == formats::PathKind::tentative ? double(p.flux[0]) : 0;
    for (const formats::GroupFlux& g : reader.ledger())
      EXPECT_EQ(g.paths, name == "1.photons" && g.group % 5 == 0 ? 1100u : 100u);
    EXPECT_EQ(reader.header().emitted_count, name == "1.photons" ? 19300u : 6300u);
    return std::pair(reader.totals().emitted_flux[0], worth);
  };
  const auto before = totals("0.photons"), after = totals("1.photons");
  EXPECT_NEAR(after.first, before.first, 1e-6 * before.first);
  // 6300 paths have a noise of 2 % in the light of the smoke. If all paths had equal flux, the groups that have
  // eleven times as many paths would be too bright.
  EXPECT_NEAR(after.second, before.second, 0.06 * before.second);
}

/// Six groups are 3 x 2 boxes of base 3 (where) and base 2; group g has the digits g mod 3 and g mod 2, each permuted.
/// A group's own value is 1000 and all others are 1: the mean of its neighbours is 1, whichever groups they are.
TEST(BesideGroups, LeavesOutOnesOwn) {
  for (const std::uint64_t seed : {0u, 1u, 7u})
    for (std::size_t g = 0; g < 6; ++g) {
      std::vector<double> values(6, 1.0);
      values[g] = 1000;
      const std::vector<double> beside = neighbour_means(values, seed);
      EXPECT_EQ(beside[g], 1);
      // In 3 x 2 boxes a corner has two neighbours and a middle box three, and each of these sees the 1000 among its
      // own two or three.
      int seen = 0;
      for (std::size_t o = 0; o < 6; ++o) seen += beside[o] > 1;
      EXPECT_TRUE(seen == 2 || seen == 3) << seen;
    }
  EXPECT_EQ(neighbour_means(std::vector<double>(11, 2.0), 0),
            std::vector<double>(11, 2.0));  // no boxes: the mean of all
  EXPECT_EQ(neighbour_means(std::vector<double>{3}, 0), std::vector<double>{3});
}

/// Refined maps have the light of plain ones in the mean: 63 groups of 4 paths, of which a twentieth of the tentative
/// photons is recorded, get five times as many more paths, over 300 seeds. If a group's own paths decided on its
/// further paths, 17 % of the light would be lost: lucky groups would be corrected and unlucky ones not. The plain maps
/// have 38 000 records of equal weight up to a factor of 2: .6 % at random, and paths have more than one record; 3 % is
/// four deviations.
TEST_F(PhotonUpdate, RefiningLosesNoLight) {
  const Room thick(2, options_);
  double before = 0, after = 0;
  const auto collided = [&](const std::string& name) {
    formats::PhotonReader reader(path(name));
    formats::PhotonBlock block;
    double sum = 0;
    while (reader.read_block(block))
      for (const formats::Photon& p : block.photons)
        sum += p.kind == formats::PathKind::tentative ? double(p.flux[0]) * double(p.normal[0]) : 0;
    return sum;
  };
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    PhotonOptions options = options_;
    options.photon_count = 252;
    options.volume_share = 0.05f;
    options.seed = seed;
    const PhotonTracer photons(*thick.tracer, *thick.lights, options);
    written("0.photons", [&](const auto& sink) { write_photon_map(photons, header(0), sink, {}); });
    const GroupMoments groups = read_moments(path("0.photons"), photons);
    written("1.photons",
            [&](const auto& sink) { write_refined_map(photons, header(0), path("0.photons"), groups, 1260, sink); });
    before += collided("0.photons");
    after += collided("1.photons");
  }
  EXPECT_NEAR(after / before, 1, 0.03);
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
