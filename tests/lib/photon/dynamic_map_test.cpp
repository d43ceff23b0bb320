// Static and dynamic maps: together the global map, photon by photon; which paths movers can touch.
#include "lib/photon/dynamic_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <vector>

#include "formats/exact_sum.h"
#include "lib/core/frame.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/photon/photon_map.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

using formats::Photon;

/// A room with a lamp on the ceiling, and a box, which moves, above its floor.
struct Room {
  test::HandMadeScene scene;
  SceneFrame frame, standing;
  EmissionTable table;

  /// lamp_moves: the lamp is a mover, too. sunny: a sun, and ground of 40 m around, in place of ceiling and lamp.
  explicit Room(Material box, bool lamp_moves = false, Vec3 at = {0.3f, 0.2f, 0.3f}, bool sunny = false) {
    const Material grey = test::matte({0.6f, 0.5f, 0.4f});
    if (sunny) {
      scene.add_quad({-20, 0, 20}, {20, 0, 20}, {20, 0, -20}, {-20, 0, -20}, grey);
      scene.add_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, grey);
      scene.add_quad({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, grey);
    } else {
      scene.add_room({0, 0, 0}, {1, 1, 1}, grey);
    }
    if (!sunny)
      scene.add_quad({0.4f, 0.99f, 0.4f}, {0.6f, 0.99f, 0.4f}, {0.6f, 0.99f, 0.6f}, {0.4f, 0.99f, 0.6f},
                     test::matte(Rgb(0.0f), Rgb(5.0f)), lamp_moves);
    scene.add_box(at, at + Vec3{0.2f, 0.2f, 0.2f}, box, true);
    frame = scene.frame();
    if (sunny) {
      PlacedLight sun;
      sun.light.kind = PunctualLight::Kind::directional;
      sun.light.intensity = Rgb(10.0f);
      sun.direction = normalize(Vec3{-0.1f, -0.8f, -0.3f});
      frame.lights.push_back(sun);
    }
    standing = static_scene_of(frame);
    table = build_emission_table(std::span(&frame, 1));
  }
};

PhotonOptions options_of(std::uint64_t count) {
  PhotonOptions options;
  options.photon_count = count;
  options.group_count = 7;
  return options;
}

/// The bytes of a photon, as a key. The flux is made positive, so that a photon of negative flux has the key of the
/// photon that it cancels.
using Key = std::array<unsigned char, sizeof(Photon)>;
Key key_of(Photon photon) {
  for (float& f : photon.flux) f = std::abs(f);
  Key key;
  std::memcpy(key.data(), &photon, sizeof photon);
  return key;
}

/// Counts photons: +1 for each, or -1 for each of negative flux.
void add(std::map<Key, int>& counts, const std::vector<Photon>& photons, int sign = 1) {
  for (const Photon& photon : photons) {
    const bool negative = photon.flux[0] < 0 || photon.flux[1] < 0 || photon.flux[2] < 0;
    counts[key_of(photon)] += negative ? -sign : sign;
  }
}

struct Maps {
  std::vector<Photon> global, fixed, dynamic;
  std::vector<formats::TouchedPath> touched;
  std::uint64_t path_count = 0;
  PhotonMapResult difference;
};

/// The photons of a map that was written to memory.
std::vector<Photon> photons_in(const std::string& bytes) {
  std::vector<Photon> photons;
  for (std::size_t at = bytes.find("PHOT", 16); at != std::string::npos && bytes.compare(at, 4, "PHOT") == 0;) {
    std::uint32_t count;
    std::memcpy(&count, bytes.data() + at + 8, 4);
    const std::size_t first = photons.size();
    photons.resize(first + count);
    std::memcpy(static_cast<void*>(photons.data() + first), bytes.data() + at + 16, count * sizeof(Photon));
    at += 16 + count * sizeof(Photon);
  }
  return photons;
}

Maps maps_of(const Room& room, std::uint64_t count, bool all_paths = false) {
  const PhotonOptions options = options_of(count);
  const Tracer whole(room.frame), without(room.standing);
  const Lights lights(room.frame, room.table), static_lights(room.standing, room.table);
  const PhotonTracer global(whole, lights, options);
  PhotonTracer fixed(without, static_lights, options);
  const MoverWatch watch({moving_boxes(room.frame)});
  fixed.watch(&watch);
  Maps maps;
  maps.path_count = global.photon_count();
  maps.global = test::photons_of(global);
  for (std::size_t b = 0; b < fixed.batch_count(); ++b) {
    const PhotonBatch batch = fixed.trace(b);
    maps.fixed.insert(maps.fixed.end(), batch.block.photons.begin(), batch.block.photons.end());
    maps.touched.insert(maps.touched.end(), batch.touched.begin(), batch.touched.end());
  }
  std::vector<std::uint64_t> paths;
  if (all_paths)
    for (std::uint64_t g = 0; g < 7; ++g)
      for (std::uint64_t p = g; p < maps.path_count; p += 7) paths.push_back(p);
  else
    for (const formats::TouchedPath& path : maps.touched) paths.push_back(path.path);
  formats::PhotonHeader header;
  header.map = "dynamic";
  std::string bytes;
  maps.difference = write_dynamic_map(
      fixed, global, paths, header,
      [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }, {});
  maps.dynamic = photons_in(bytes);
  return maps;
}

void expect_sum(const Maps& maps) {
  std::map<Key, int> counts;
  add(counts, maps.fixed);
  add(counts, maps.dynamic);
  add(counts, maps.global, -1);
  int left = 0;
  for (const auto& [key, count] : counts) left += std::abs(count);
  EXPECT_EQ(left, 0) << "photons of static + dynamic that are not those of global";
  formats::ExactRgbSum sum, global;
  for (const auto* photons : {&maps.fixed, &maps.dynamic})
    for (const Photon& photon : *photons) sum.add(photon.flux);
  for (const Photon& photon : maps.global) global.add(photon.flux);
  EXPECT_EQ(sum.rounded(), global.rounded());
}

/// Seen to fail: photons that a mover takes away left out.
TEST(DynamicMap, StaticAndDynamicAreGlobalPhotonByPhoton) {
  Material glossy = test::matte(Rgb(0.5f));
  glossy.metallic = 1, glossy.roughness = 0.1f;
  for (const Material& box : {test::matte(Rgb(0.5f)), glossy}) {
    const Room room(box);
    const Maps maps = maps_of(room, 20000);
    expect_sum(maps);
    EXPECT_FALSE(maps.dynamic.empty());
    EXPECT_LT(maps.touched.size(), maps.path_count / 2);
  }
}

TEST(DynamicMap, NoPathThatDiffersIsMissed) {
  const Room room(test::matte(Rgb(0.5f)));
  const Maps found = maps_of(room, 10000), all = maps_of(room, 10000, true);
  EXPECT_EQ(found.dynamic, all.dynamic);
}

TEST(DynamicMap, AMovingLampsPhotonsAreAllDynamic) {
  const Room room(test::matte(Rgb(0.5f)), true);
  const Maps maps = maps_of(room, 5000);
  EXPECT_TRUE(maps.fixed.empty());
  EXPECT_EQ(maps.touched.size(), maps.path_count);
  expect_sum(maps);
  EXPECT_EQ(maps.dynamic.size(), maps.global.size());
}

TEST(DynamicMap, AimedPhotonsOfASunAreTheSamePhotonsInBothScenes) {
  // Two walls and a moving box stand in the sun on wide ground, and photons are aimed at them. If they were aimed in
  // one of the two scenes only, starts and fluxes would differ.
  Room room(test::matte(Rgb(0.5f)), false, {0.3f, 0.2f, 0.3f}, true);
  room.table.aim = {{{0.5, 0.5, 0.5}, 0.875, 0.75}, {{0.4, 0.3, 0.4}, 0.25, 0.25}};
  const Maps maps = maps_of(room, 20000);
  expect_sum(maps);
  EXPECT_FALSE(maps.dynamic.empty());
  EXPECT_LT(maps.touched.size(), maps.path_count);
  const Maps all = maps_of(room, 20000, true);
  EXPECT_EQ(maps.dynamic, all.dynamic);
  Room uniform(test::matte(Rgb(0.5f)), false, {0.3f, 0.2f, 0.3f}, true);
  EXPECT_LT(2 * maps_of(uniform, 20000).dynamic.size(), maps.dynamic.size());  // they do come where they are aimed
}

TEST(DynamicMap, WhereNothingIsMetThereIsNothing) {
  const Room room(test::matte(Rgb(0.5f)), false, {5, 5, 5});  // outside the room
  const Maps maps = maps_of(room, 5000);
  EXPECT_TRUE(maps.touched.empty());
  EXPECT_TRUE(maps.dynamic.empty());
  EXPECT_EQ(maps.global, maps.fixed);
}

TEST(DynamicMap, FluxThatIsGoneIsFluxThatIsElsewhere) {
  // emitted = escaped + absorbed in both scenes, so also in the difference; a static lamp emits the same in both.
  const Room room(test::matte(Rgb(0.5f)));
  const PhotonMapResult r = maps_of(room, 5000).difference;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(r.totals.emitted_flux[c], 0);
    EXPECT_NEAR(r.totals.escaped_flux[c] + r.totals.absorbed_flux[c], 0, 1e-9);
  }
}

TEST(MoverWatch, BitsAreTheIntervalsWhoseBoxesAreMet) {
  std::vector<MovingBoxes> intervals(64);
  intervals[0].surfaces = {{{0, 0, 0}, {1, 1, 1}}}, intervals[0].all = intervals[0].surfaces[0];
  intervals[63].surfaces = {{{0, 0, 0}, {1, 1, 1}}, {{9, 0, 0}, {10, 1, 1}}};
  for (const Box3& box : intervals[63].surfaces) intervals[63].all.add(box);
  const MoverWatch watch(intervals);
  EXPECT_EQ(watch.all(), ~std::uint64_t(0));
  const Ray up{{0.5f, -5, 0.5f}, {0, 1, 0}, 0, INFINITY}, far{{9.5f, -5, 0.5f}, {0, 1, 0}, 0, INFINITY},
      between{{5, -5, 0.5f}, {0, 1, 0}, 0, INFINITY};
  EXPECT_EQ(watch.touching(up, INFINITY), 1 | std::uint64_t(1) << 63);
  EXPECT_EQ(watch.touching(far, INFINITY), std::uint64_t(1) << 63);
  EXPECT_EQ(watch.touching(between, INFINITY), 0u);  // the interval's box of all is met, none of its surfaces'
  EXPECT_EQ(watch.touching(up, 4.9f), 0u);
  EXPECT_NE(watch.touching(up, 5.1f), 0u);
}

/// Rays from all sides, from a metre to 10 km away, past a ball of 512 triangles. A convex body is met by random
/// lines in proportion to its surface (Cauchy: the mean shadow is a quarter of the surface). The ball has 4 pi r^2
/// and its box 24 r^2, so the box is met 1.91 times as often.
TEST(MoverWatch, PiecesOfABallAreMetWhereItIsAndHardlyElsewhere) {
  test::HandMadeScene scene;
  const Vec3 centre{0.3f, 1.2f, -0.7f};
  const float radius = 0.25f;
  scene.add_sphere(centre, radius, 8, test::matte(Rgb(0.5f)), false, false, true);
  const SceneFrame frame = scene.frame();
  const Tracer tracer(frame);
  MovingBoxes pieces = moving_boxes(frame), box = pieces;
  ASSERT_EQ(pieces.pieces_of(0).size(), 64u);
  box.pieces.clear();
  const MoverWatch by_pieces({pieces}), by_box({box});
  const PathRandom random{2, 1};
  int met = 0, touched = 0, near_box = 0;
  for (std::uint32_t i = 0; i < 60000; ++i) {
    // Uniform lines: a direction, and a place on the disc across it that holds the box.
    const Vec3 direction = test::sample_sphere(random.get2(i, Purpose::test));
    const Vec2 u = random.get2(i, Purpose::test, 1);
    const Frame across(direction);
    const float r = 1.8f * radius * std::sqrt(u.x), turn = float(2 * M_PI) * u.y, far = std::pow(10.0f, float(i % 5));
    const Vec3 origin = centre + across.to_world({r * std::cos(turn), r * std::sin(turn), 0}) - direction * far;
    Hit hit;
    const Ray ray{origin, direction, 0, INFINITY};
    const bool hits = tracer.intersect(ray, hit), meets = by_pieces.touching(ray, INFINITY) != 0;
    if (hits) { ASSERT_NE(by_pieces.touching(ray, hit.t), 0u) << "from " << far << " m"; }
    met += hits;
    touched += meets;
    near_box += by_box.touching(ray, INFINITY) != 0;
  }
  EXPECT_NEAR(double(near_box) / met, 1.91, 0.06);  // 18 000 hits: 1 %; the ball's flat triangles lie 1 % inside it
  EXPECT_LT(double(touched) / met, 1.55);
  EXPECT_GE(touched, met);
}

TEST(MoverWatch, WhatLiesBetweenAPointAndABoxOfLightsIsNotMissed) {
  MovingBoxes boxes;
  boxes.surfaces = {{{-0.2f, 0.4f, -0.2f}, {0.2f, 0.6f, 0.2f}}};
  boxes.all = boxes.surfaces[0];
  const MoverWatch watch({boxes});
  const Box3 lights{{-0.5f, 2, -0.5f}, {0.5f, 2.1f, 0.5f}};
  const PathRandom random{1, 1};
  int met = 0, clear = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec2 a = random.get2(i, Purpose::test), b = random.get2(i, Purpose::test, 1);
    const Vec3 from{4 * a.x - 2, 0, 4 * a.y - 2}, to{b.x - 0.5f, 2.05f, b.y - 0.5f};
    const bool meets = watch.touching({from, to - from, 0, INFINITY}, 1) != 0;
    if (meets) { ASSERT_TRUE(watch.between(from, lights)); }
    met += meets;
    clear += !watch.between(from, lights);
  }
  EXPECT_GT(met, 300);
  EXPECT_GT(clear, 10000);  // points from which no way to the lights leads by the box
  EXPECT_FALSE(watch.between({5, 0, 0}, {{5, 2, 0}, {5, 2, 0}}));
}

}  // namespace
}  // namespace tempolux
