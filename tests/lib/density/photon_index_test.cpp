// PhotonIndex against brute force: every answer must be the same set, to the bit.
#include "lib/density/photon_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

using formats::PathKind;
using formats::Photon;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Vec2 random2(std::uint64_t i, std::uint32_t use) { return PathRandom(7, i).get2(use, Purpose::test); }

Photon photon_at(Vec3 p, std::uint64_t i) {
  const Vec3 n = test::sample_sphere(random2(i, 90));
  Photon photon{.position = {p.x, p.y, p.z}, .flux = {float(i % 17), 1, -2}};
  photon.normal = formats::encode_normal({n.x, n.y, n.z});
  photon.kind = PathKind(i % 4);
  return photon;
}

/// Shapes of point sets for which search trees tend to fail.
enum class Shape { cube, clusters, plane, coincident, line_of_copies, far_away, lattice };
const std::vector<std::pair<Shape, std::string>> kShapes{{Shape::cube, "cube"},
                                                         {Shape::clusters, "clusters"},
                                                         {Shape::plane, "plane"},
                                                         {Shape::coincident, "coincident"},
                                                         {Shape::line_of_copies, "line of copies"},
                                                         {Shape::far_away, "far away"},
                                                         {Shape::lattice, "lattice"}};

Vec3 place(Shape shape, std::uint64_t i) {
  const Vec2 u = random2(i, 1), v = random2(i, 2);
  switch (shape) {
    case Shape::cube: return {u.x, u.y, v.x};
    case Shape::clusters: {
      const Vec2 c = random2(i % 5, 3);
      const float size = std::pow(10.0f, -float(i % 5));
      return {c.x + size * (u.x - 0.5f), c.y + size * (u.y - 0.5f), size * (v.x - 0.5f)};
    }
    case Shape::plane: return {u.x, 0.25f, u.y};
    case Shape::coincident: return {0.3f, 0.4f, 0.5f};
    case Shape::line_of_copies: return {float(i % 10), 0, 0};
    case Shape::far_away: return {1e5f + u.x, -1e5f + u.y, 1e5f + v.x};  // float step 1/128: many ties
    case Shape::lattice: return {std::floor(u.x * 12), std::floor(u.y * 12), std::floor(v.x * 12)};
  }
  return {};
}

std::vector<Photon> photons_of(Shape shape, std::size_t count) {
  std::vector<Photon> photons;
  for (std::size_t i = 0; i < count; ++i) photons.push_back(photon_at(place(shape, i), i));
  return photons;
}

using Found = std::vector<std::pair<float, std::uint32_t>>;

/// The definition in photon_index.h, word for word.
bool passes(const PhotonIndex& index, const PhotonQuery& query, std::uint32_t i, float& distance2) {
  const Vec3 d = index.position(i) - query.point;
  distance2 = dot(d, d);
  if (query.flattening != 1) {
    const float h = dot(d, query.normal);
    distance2 += (query.flattening * query.flattening - 1) * (h * h);
  }
  if (!(distance2 <= query.max_radius * query.max_radius)) return false;
  const Vec3 n = index.normal(i);
  const Vec3 steps{std::round(n.x * 511), std::round(n.y * 511), std::round(n.z * 511)};
  return query.min_cos <= kAnyNormal || dot(steps, query.normal) > query.min_cos * 511;
}

Found all_passing(const PhotonIndex& index, const PhotonQuery& query) {
  Found found;
  float distance2;
  for (std::uint32_t i = 0; i < index.size(); ++i)
    if (passes(index, query, i, distance2)) found.push_back({distance2, i});
  return found;
}

Found contents(const NeighbourList& list) {
  Found found;
  for (std::size_t i = 0; i < list.count(); ++i) found.push_back({list.distance2()[i], list.photons()[i]});
  return found;
}

/// Compares both searches for one query with brute force.
void expect_exact(const PhotonIndex& index, const PhotonQuery& query, const std::vector<int>& ks, NeighbourList& list) {
  Found all = all_passing(index, query);
  index.find_within(query, list);
  ASSERT_EQ(contents(list), all);
  std::sort(all.begin(), all.end());
  for (int k : ks) {
    SCOPED_TRACE("k = " + std::to_string(k));
    const Found nearest(all.begin(), all.begin() + std::min<std::ptrdiff_t>(k, std::ssize(all)));
    Found by_place = nearest;
    std::sort(by_place.begin(), by_place.end(), [](auto a, auto b) { return a.second < b.second; });
    index.find_nearest(query, k, list);
    ASSERT_EQ(contents(list), by_place);
    if (!nearest.empty()) { EXPECT_EQ(contents(list)[list.farthest()], nearest.back()); }
    list.sort_by_distance();
    ASSERT_EQ(contents(list), nearest);
    if (!nearest.empty()) { EXPECT_EQ(list.farthest(), nearest.size() - 1); }
  }
}

/// A query at or near a photon, or off the set; `variant` picks the options.
PhotonQuery query_of(Shape shape, std::uint64_t q, int variant) {
  PhotonQuery query{.point = place(shape, q % 3 == 0 ? q : q + 1000000)};
  if (q % 5 == 1) query.point += Vec3{0.1f, -0.2f, 0.05f};
  if (q % 7 == 2) query.point += Vec3{30, 0, 5};
  query.normal = test::sample_sphere(random2(q, 91));
  if (q % 4 == 0) query.normal = {0, 1, 0};
  if (variant & 1) query.max_radius = std::pow(10.0f, 1.5f - 3 * random2(q, 92).x);
  if (variant & 2) query.min_cos = random2(q, 93).x - 0.3f;
  if (variant & 4) query.flattening = 10;
  return query;
}

TEST(PhotonIndex, FindsExactlyWhatBruteForceFindsInEveryShapeAndWithEveryOption) {
  NeighbourList list;  // one for all: what it remembers must not matter
  for (const auto& [shape, name] : kShapes) {
    for (std::size_t count : {1u, 7u, 31u, 32u, 33u, 257u, 3000u}) {
      const PhotonIndex index(photons_of(shape, count));
      const int queries = count == 3000 ? 12 : 3;
      for (int variant = 0; variant < 8; ++variant)
        for (int q = 0; q < queries; ++q) {
          SCOPED_TRACE(name + ", " + std::to_string(count) + " photons, variant " + std::to_string(variant) +
                       ", query " + std::to_string(q));
          expect_exact(index, query_of(shape, std::uint64_t(q), variant), {1, 2, 8, 50, 100, 512}, list);
          if (HasFatalFailure()) return;
        }
    }
  }
}

TEST(PhotonIndex, IsExactForEveryKFrom1To512) {
  const PhotonIndex index(photons_of(Shape::clusters, 2000));
  NeighbourList list;
  std::vector<int> ks(512);
  for (int k = 1; k <= 512; ++k) ks[std::size_t(k - 1)] = k;
  for (int q = 0; q < 6; ++q) expect_exact(index, query_of(Shape::clusters, std::uint64_t(q), q % 2), ks, list);
}

TEST(PhotonIndex, IsExactAlongAPathOfQueriesThroughManyPhotons) {
  // 50 000 photons in sheets, with queries along lines as a renderer makes them: deep trees, remembered radii.
  std::vector<Photon> photons;
  for (std::uint64_t i = 0; i < 50000; ++i) {
    const Vec2 u = random2(i, 1);
    photons.push_back(photon_at({u.x, u.y * u.y, float(i % 2) * 1e-3f}, i));
  }
  const PhotonIndex index(photons);
  NeighbourList list;
  for (int q = 0; q < 60; ++q) {
    const float s = float(q % 20) / 20;
    PhotonQuery query{.point = {s, s * (q < 20 ? 1.0f : 0.1f), 0}, .normal = {0, 0, 1}};
    if (q >= 40) query.min_cos = 0.2f;
    expect_exact(index, query, {50}, list);
  }
}

TEST(PhotonIndex, ManyCoincidentPhotonsDoNotMakeASearchLong) {
  // 400 000 photons at one point against 400: the same search except for the tree's depth. A search that cannot skip
  // equal distances reads all photons and takes hundreds of times as long. The best of five runs, because the machine
  // may be busy.
  const PhotonIndex few(photons_of(Shape::coincident, 400)), many(photons_of(Shape::coincident, 400000));
  NeighbourList list;
  const auto seconds = [&](const PhotonIndex& index) {
    double best = 1e9;
    for (int round = 0; round < 5; ++round) {
      const auto start = std::chrono::steady_clock::now();
      for (int q = 0; q < 100; ++q) index.find_nearest({.point = {0.3f, 0.4f, 0.5f}}, 50, list);
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
  };
  const double seconds_few = seconds(few);
  EXPECT_LT(seconds(many), 30 * seconds_few);
  ASSERT_EQ(list.count(), 50u);
  for (std::uint32_t i = 0; i < 50; ++i) EXPECT_EQ(list.photons()[i], i);
  EXPECT_EQ(many.source(0), 0u) << "equal points keep their order";
}

TEST(PhotonIndex, KeepsEveryPhotonOnceWithItsData) {
  const std::vector<Photon> photons = photons_of(Shape::cube, 5000);
  const PhotonIndex index(photons);
  ASSERT_EQ(index.size(), photons.size());
  std::vector<bool> seen(photons.size());
  for (std::size_t i = 0; i < index.size(); ++i) {
    const Photon& p = photons[index.source(i)];
    EXPECT_FALSE(seen[index.source(i)]);
    seen[index.source(i)] = true;
    EXPECT_EQ(index.position(i), (Vec3{p.position[0], p.position[1], p.position[2]}));
    EXPECT_EQ(index.flux(i), Rgb(p.flux[0], p.flux[1], p.flux[2]));
    const auto n = formats::decode_normal(p.normal);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(index.normal(i)[axis], n[std::size_t(axis)], 0.5001 / 511);
  }
}

// 40000 photons are several chunks of the parallel loops; a quarter is of each kind.
TEST(PhotonIndex, OfSomeKindsMovedIsThatOfThesePhotonsAlone) {
  const std::vector<Photon> photons = photons_of(Shape::cube, 40000);
  const Vec3d shift{10, -20, 0.5};
  std::vector<Photon> chosen;
  std::vector<std::uint32_t> sources;
  for (std::uint32_t i = 0; i < photons.size(); ++i) {
    if (photons[i].kind != PathKind::caustic && photons[i].kind != PathKind::volume) continue;
    const auto& p = photons[i].position;
    chosen.push_back(photons[i]);
    chosen.back().position = {float(p[0] + shift.x), float(p[1] + shift.y), float(p[2] + shift.z)};
    sources.push_back(i);
  }
  const PhotonIndex expected(chosen);
  const PhotonIndex index(photons, kind_bit(PathKind::caustic) | kind_bit(PathKind::volume), shift);
  ASSERT_EQ(index.size(), 20000u);
  ASSERT_EQ(expected.size(), index.size());
  EXPECT_EQ(index.resolution(), expected.resolution());
  for (std::size_t i = 0; i < index.size(); ++i) {
    ASSERT_EQ(index.position(i), expected.position(i));
    ASSERT_EQ(index.source(i), sources[expected.source(i)]);
    ASSERT_EQ(index.flux(i), expected.flux(i));
    ASSERT_EQ(index.normal(i), expected.normal(i));
  }
}

TEST(PhotonIndex, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Photon> photons = photons_of(Shape::lattice, 40000);
  const PhotonIndex reference(photons);
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    const PhotonIndex index(photons);
    for (std::size_t i = 0; i < index.size(); ++i) ASSERT_EQ(index.source(i), reference.source(i)) << threads;
  }
}

TEST(PhotonIndex, WithoutPhotonsOrWithAPointThatIsNotFiniteFindsNothing) {
  NeighbourList list;
  const PhotonIndex empty, none(std::vector<Photon>{}), some(photons_of(Shape::cube, 100));
  for (const PhotonIndex* index : {&empty, &none}) {
    index->find_nearest({}, 5, list);
    EXPECT_EQ(list.count(), 0u);
    index->find_within({}, list);
    EXPECT_EQ(list.count(), 0u);
  }
  for (float bad : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
    some.find_nearest({.point = {0, bad, 0}}, 5, list);
    EXPECT_EQ(list.count(), 0u);
    some.find_within({.point = {bad, 0, 0}}, list);
    EXPECT_EQ(list.count(), 0u);
  }
}

TEST(PhotonIndex, RefusesAnUnusableKAndPhotonsThatAreNotFinite) {
  NeighbourList list;
  const PhotonIndex index(photons_of(Shape::cube, 10));
  EXPECT_THROW(index.find_nearest({}, 0, list), std::invalid_argument);
  EXPECT_THROW(index.find_nearest({}, kMaxNeighbours + 1, list), std::invalid_argument);
  std::vector<Photon> photons = photons_of(Shape::cube, 10);
  photons[3].position[1] = kInfinity;
  EXPECT_THROW(PhotonIndex{photons}, std::invalid_argument);
  photons = photons_of(Shape::cube, 10);
  photons[9].flux[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(PhotonIndex{photons}, std::invalid_argument);
}

}  // namespace
}  // namespace tempolux
