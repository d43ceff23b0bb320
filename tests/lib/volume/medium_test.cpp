// Voxels, majorants and free flight against answers known on paper (docs/methods/formulas.md).
#include "lib/volume/medium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "lib/core/random.h"
#include "lib/volume/flight.h"
#include "lib/volume/phase.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

/// Blocks from (0, 0, 0) to (n-1, n-1, n-1), voxel values by a function of the place.
template <class F>
std::shared_ptr<const VoxelGrid> grid_of(int n, const F& value) {
  std::vector<VoxelBlock> blocks;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) {
        VoxelBlock block{{8 * x, 8 * y, 8 * z}, {}};
        for (int i = 0; i < 512; ++i)
          block.values[std::size_t(i)] = value(8 * x + i / 64, 8 * y + i / 8 % 8, 8 * z + i % 8);
        blocks.push_back(block);
      }
  return std::make_shared<const VoxelGrid>(blocks);
}

Affine scaled(double s, Vec3d t = {}) {
  Affine a;
  a.row = {Vec3d{s, 0, 0}, Vec3d{0, s, 0}, Vec3d{0, 0, s}};
  a.translation = t;
  return a;
}

/// A cube of n blocks of density 1, `edge` m from the border of its first voxel to that of its last. Its depth along
/// an axis is edge x sigma_t: the ramps at both ends, each a voxel long, hold half a voxel each.
Media cube(int n, double edge, MediumOptions options) {
  const double voxel = edge / (8 * n);
  std::vector<Medium> media;
  media.emplace_back(grid_of(n, [](int, int, int) { return 1.0f; }), scaled(voxel), options);
  return Media(std::move(media));
}

struct Numbers {
  PathRandom random;
  std::uint32_t bounce;
  std::uint64_t operator()(std::uint32_t k) const { return random.bits(bounce, Purpose::flight, k); }
};

TEST(VoxelGrid, TrilinearBetweenVoxelsAcrossBlocks) {
  const auto linear = [](int x, int y, int z) { return float(1 + 2 * x + 3 * y + 5 * z); };
  const auto grid = grid_of(2, linear);
  for (const Vec3 p : {Vec3{0.25f, 3.5f, 6.75f}, Vec3{7.5f, 7.5f, 7.5f}, Vec3{7.999f, 8, 14.5f}, Vec3{15, 15, 15}})
    EXPECT_NEAR(grid->at(p), 1 + 2 * p.x + 3 * p.y + 5 * p.z, 1e-4f);  // a linear field is reproduced
  EXPECT_FLOAT_EQ(grid->at({-0.5f, 0, 0}), 0.5f);                      // half-way to the nothing outside
  EXPECT_FLOAT_EQ(grid->at({0, 15.75f, 0}), 0.25f * 46);
  EXPECT_EQ(grid->at({-1, 0, 0}), 0);
  EXPECT_EQ(grid->at({16, 3, 3}), 0);
  EXPECT_EQ(grid->at({NAN, 3, 3}), 0);
  EXPECT_EQ(grid->at({1e30f, 3, 3}), 0);
  EXPECT_FLOAT_EQ(grid->at({15, 15, 15}), 151);
  EXPECT_EQ(grid->at({16, 0, 0}), 0);
}

TEST(VoxelGrid, NegativePlacesSparseBlocksAndBounds) {
  VoxelBlock a{{-16, 8, 0}, {}}, b{{800, 8, 0}, {}}, nothing{{80, 80, 80}, {}};
  a.values[0] = 2;    // voxel (-16, 8, 0): its neighbours' blocks must know it
  b.values[511] = 3;  // voxel (807, 15, 7)
  const VoxelGrid grid({a, nothing, b});
  EXPECT_FLOAT_EQ(grid.at({-16.5f, 7.5f, -0.5f}), 0.25f);
  EXPECT_FLOAT_EQ(grid.at({807.5f, 15, 7}), 1.5f);
  EXPECT_EQ(grid.at({400, 8, 0}), 0);
  EXPECT_EQ(grid.support().lower, (Vec3d{-17, 7, -1}));
  EXPECT_EQ(grid.support().upper, (Vec3d{808, 16, 8}));
  EXPECT_EQ(grid.largest({{-20, 0, -5}, {-16.5, 20, 5}}), 2);  // the apron: trilinear reaches one voxel on
  EXPECT_EQ(grid.largest({{0, 0, 0}, {700, 20, 20}}), 0);
  EXPECT_EQ(grid.hash(), VoxelGrid({b, a}).hash());
  EXPECT_TRUE(VoxelGrid(std::vector<VoxelBlock>{nothing}).empty());
}

TEST(VoxelGrid, RefusesWhatIsNoDensity) {
  VoxelBlock block{};
  block.values[3] = -1;
  EXPECT_THROW(VoxelGrid({block}), std::invalid_argument);
  block.values[3] = NAN;
  EXPECT_THROW(VoxelGrid({block}), std::invalid_argument);
  block.values[3] = 1;
  EXPECT_THROW(VoxelGrid({block, block}), std::invalid_argument);
  block.origin = {4, 0, 0};
  EXPECT_THROW(VoxelGrid({block}), std::invalid_argument);
  VoxelBlock near{{0, 0, 0}, {}}, far{{1 << 27, 1 << 27, 1 << 27}, {}};
  near.values[0] = far.values[0] = 1;
  EXPECT_THROW(VoxelGrid({near, far}), std::invalid_argument);
}

TEST(Medium, OpticalDepthIsExact) {
  // sigma = z / 10 between the voxels, so a path along z from 2.3 to 9.1 has the depth (9.1^2 - 2.3^2) / 20.
  std::vector<Medium> media;
  media.emplace_back(grid_of(2, [](int, int, int z) { return 0.1f * float(z); }), scaled(1), MediumOptions{});
  const Media linear(std::move(media));
  EXPECT_NEAR(linear.optical_depth({3, 3, 2.3f}, {0, 0, 1}, 6.8), (9.1 * 9.1 - 2.3 * 2.3) / 20, 1e-5);
  // A product of linear fields is cubic along a diagonal: x y z from (1,1,1) to (6,6,6) has the depth integral of s^3
  // sqrt(3) ds.
  std::vector<Medium> cubic;
  cubic.emplace_back(grid_of(1, [](int x, int y, int z) { return float(x * y * z); }), scaled(1), MediumOptions{});
  const float d = 1 / std::sqrt(3.0f);
  EXPECT_NEAR(Media(std::move(cubic)).optical_depth({1, 1, 1}, {d, d, d}, 5 * std::sqrt(3.0)),
              std::sqrt(3.0) * (1296 - 1) / 4, 0.01);  // rounding of places near voxels: 1e-6 of 560
  EXPECT_NEAR(cube(2, 1, {.sigma_t = 2}).optical_depth({-5, 0.4f, 0.4f}, {1, 0, 0}, INFINITY), 2, 1e-6);
}

TEST(Majorants, NoPointExceedsThemAndPiecesJoin) {
  std::vector<Medium> media;
  const auto rough = [](int x, int y, int z) {
    return float(mix64(std::uint64_t(x * 961 + y * 31 + z)) >> 40) * 1e-5f;
  };
  Affine askew = scaled(0.1, {3, -2, 1});
  askew.row[0] = {0.08, 0.05, 0};
  askew.row[1] = {-0.05, 0.08, 0.02};
  media.emplace_back(grid_of(4, rough), askew, MediumOptions{.sigma_t = 3});
  const Media all(std::move(media));
  const PathRandom random(1, 2);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Vec3 from{random.get1(i, Purpose::test, 0) * 8, random.get1(i, Purpose::test, 1) * 8 - 4,
                    random.get1(i, Purpose::test, 2) * 8 - 2};
    const Vec3 direction = test::sample_sphere(random.get2(i, Purpose::test, 3));
    MajorantWalk walk(all.majorants(), from, direction, 7);
    float last = -1;
    for (MajorantWalk::Piece piece; walk.next(piece); last = piece.end) {
      ASSERT_TRUE(last < 0 || piece.begin == last);
      ASSERT_GE(piece.end, piece.begin);
      ASSERT_LE(piece.end, 7);
      for (float f : {0.0f, 0.3f, 0.7f, 1.0f})
        ASSERT_LE(all.extinction(from + direction * (piece.begin + f * (piece.end - piece.begin))), piece.majorant);
    }
  }
}

TEST(Majorants, AxisParallelRaysAndRaysThatMiss) {
  const Media media = cube(2, 1, {});
  float covered = 0;
  MajorantWalk along(media.majorants(), {0.3f, 0.3f, -4}, {0, -0.0f, 1}, INFINITY);
  for (MajorantWalk::Piece piece; along.next(piece);) covered += piece.end - piece.begin;
  EXPECT_NEAR(covered, 1 + 1 / 16.0, 1e-5);  // 16 voxels and the ramps
  // On a plane between cells, all but along it: 1 / 1e-40 is infinite.
  const auto pieces = [&](float aside) {
    MajorantWalk walk(media.majorants(), {float(media.majorants().cell(1, 0, 0).lower.x), 0.3f, -4}, {aside, 0, 1},
                      INFINITY);
    int n = 0;
    for (MajorantWalk::Piece piece; walk.next(piece);) ++n;
    return n;
  };
  EXPECT_GT(pieces(0), 1);
  EXPECT_EQ(pieces(1e-40f), pieces(0));
  EXPECT_EQ(pieces(-1e-40f), pieces(0));
  MajorantWalk::Piece piece;
  EXPECT_FALSE(MajorantWalk(media.majorants(), {3, 0.3f, -4}, {0, 0, 1}, INFINITY).next(piece));
  EXPECT_FALSE(MajorantWalk(media.majorants(), {0.3f, 0.3f, -4}, {0, 0, 1}, 3).next(piece));
  EXPECT_FALSE(MajorantWalk(media.majorants(), {0.3f, 0.3f, -4}, {0, 0, -1}, INFINITY).next(piece));
}

TEST(Majorants, FrozenOnesMustHold) {
  const auto one = grid_of(1, [](int, int, int) { return 1.0f; });
  const auto medium = [&](float sigma) { return std::vector<Medium>{Medium(one, scaled(1), {.sigma_t = sigma})}; };
  const MajorantGrid of_two = Media(medium(2)).majorants();
  EXPECT_NO_THROW(Media(medium(1), of_two));
  EXPECT_THROW(Media(medium(3), of_two), std::invalid_argument);
  EXPECT_THROW(Media({Medium(one, scaled(1.5), {})}, of_two), std::invalid_argument);
}

/// The transmittance of slabs of depth tau, by collisions and by ratio tracking.
TEST(Flight, PassesByBeerAndLambert) {
  for (const float tau : {1e-6f, 1e-3f, 0.1f, 1.0f, 5.0f, 1e4f}) {
    const Media media = cube(2, 1, {.sigma_t = tau});
    const int n = 40000;
    double passed = 0, ratio = 0, ratio2 = 0;
    for (int i = 0; i < n; ++i) {
      const Numbers numbers{PathRandom(7, std::uint64_t(i)), 0}, others{PathRandom(8, std::uint64_t(i)), 0};
      passed += first_collision(media, {-1, 0.5f, 0.4f}, {1, 0, 0}, 4, numbers) == INFINITY;
      const double t = estimate_transmittance(media, {-1, 0.5f, 0.4f}, {1, 0, 0}, 4, others);
      ratio += t;
      ratio2 += t * t;
    }
    const double exact = std::exp(-double(tau)), deviation = std::sqrt(exact * (1 - exact) / n);
    EXPECT_NEAR(passed / n, exact, 4 * deviation + 1e-12) << tau;
    const double mean = ratio / n, ratio_deviation = std::sqrt(std::max(0.0, ratio2 / n - mean * mean) / n);
    EXPECT_NEAR(mean, exact, 4 * deviation + 1e-7) << tau;  // 1e-7: a step of float32 below 1
    EXPECT_LE(ratio_deviation, deviation * 1.5 + 1e-7) << tau;
  }
}

/// 1 - T of tau = 1e-6, which a random number of 24 bits would have 1.3 % too high.
TEST(Flight, KeepsThinMediaExact) {
  double sum = 0;
  const int steps = 1 << 14;  // all words that can collide, in strides
  for (int i = 0; i < steps; ++i) {
    const std::uint64_t high = std::uint64_t(i);  // u = i 2^-32
    sum += FlightNumbers(high << 32).depth < 1e-6f;
  }
  EXPECT_NEAR(sum * 0x1p-32, -std::expm1(-1e-6), 0.0005e-6);
}

/// The share of light at normal incidence that a half-space of isotropic scattering reflects: 1 - sqrt(1 - w) H(1).
/// Chandrasekhar 1950; values of docs/methods/formulas.md. The share is the same for any profile of density along the
/// normal.
TEST(Flight, HalfSpaceReflectsByChandrasekhar) {
  const Media media = cube(3, 24000, {});  // voxels of 1000 free ways
  struct Case {
    double albedo, reflected;
  };
  for (const Case& c : {Case{0.5, 0.115226}, Case{0.9, 0.414947}, Case{0.99, 0.752721}}) {
    const int n = 60000;
    double back = 0;
    for (int i = 0; i < n; ++i) {
      const PathRandom random(3, std::uint64_t(i));
      Vec3 at{12000, 12000, -2000}, travel{0, 0, 1};
      for (std::uint32_t bounce = 0;; ++bounce) {
        const float t = first_collision(media, at, travel, INFINITY, Numbers{random, bounce});
        if (t == INFINITY) {
          back += travel.z < 0;
          break;
        }
        at += travel * t;
        if (random.get1(bounce, Purpose::lobe) >= c.albedo) break;
        travel = sample_hg(0, travel, random.get2(bounce, Purpose::phase));
      }
    }
    EXPECT_NEAR(back / n, c.reflected, 4 * std::sqrt(c.reflected * (1 - c.reflected) / n)) << c.albedo;
  }
}

TEST(Flight, LooksAtTheSamePlacesUnderFrozenMajorants) {
  const auto one = grid_of(2, [](int, int, int) { return 1.0f; });
  const auto half = grid_of(2, [](int x, int, int) { return x < 8 ? 1.0f : 0.5f; });
  const Media before({Medium(one, scaled(1), {})});
  const Media after({Medium(half, scaled(1), {})}, before.majorants());
  Flight a(before.majorants(), {-3, 4, 4}, {1, 0, 0}, 30), b(after.majorants(), {-3, 4, 4}, {1, 0, 0}, 30);
  Tentative ta, tb;
  int seen = 0;
  for (std::uint32_t k = 0;; ++k, ++seen) {
    const float depth = FlightNumbers(PathRandom(5, 6).bits(0, Purpose::flight, k)).depth;
    const bool more = a.next(depth, ta);
    ASSERT_EQ(b.next(depth, tb), more);
    if (!more) break;
    EXPECT_EQ(ta.distance, tb.distance);
  }
  EXPECT_GT(seen, 5);
}

TEST(Phase, HenyeyGreensteinHasItsMomentsAndPdf) {
  for (const float g : {-0.9f, -1e-5f, 0.0f, 0.3f, 0.9f, 0.999f}) {
    // Mean of cos over xi is g: midpoints, error of their second order.
    const int n = 200000;
    double mean = 0;
    for (int i = 0; i < n; ++i) mean += 1 - double(sample_hg_one_minus_cos(g, (float(i) + 0.5f) / n));
    EXPECT_NEAR(mean / n, g, 2e-5);
    // Distribution against density: the integral of the density up to a quantile is that quantile.
    for (const float xi : {0.25f, 0.5f, 0.75f}) {
      const double m = sample_hg_one_minus_cos(g, xi);
      double integral = 0;
      const int steps = 20000;
      for (int i = 0; i < steps; ++i) {  // from straight on, in the square root: narrow lobes get their points
        const double s = std::sqrt(m) * (i + 0.5) / steps;
        integral += pdf_hg(g, float(s * s)) * 2 * kPi * 2 * s * (std::sqrt(m) / steps);
      }
      EXPECT_NEAR(integral, g < 0 ? xi : 1 - xi, 1e-3) << g << ' ' << xi;
    }
  }
  EXPECT_NEAR(pdf_hg(0, {0, 0, 1}, {1, 0, 0}), 1 / (4 * kPi), 1e-7);
}

}  // namespace
}  // namespace tempolux
