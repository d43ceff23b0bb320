// Photons: flux by closed form, balance of flux, and independence of batches, groups and threads.
#include "lib/photon/photon_trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <algorithm>
#include <numeric>
#include <tuple>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/photon/photon_map.h"
#include "tests/support/closed_box.h"

namespace tempolux {
namespace {

using test::Shape;

struct Sums {
  Rgbd stored{0.0}, emitted{0.0}, escaped{0.0}, absorbed{0.0};
  std::vector<formats::Photon> photons;
};

Sums trace_all(const PhotonTracer& tracer) {
  Sums sums;
  for (std::size_t b = 0; b < tracer.batch_count(); ++b) {
    const PhotonBatch batch = tracer.trace(b);
    for (const formats::Photon& photon : batch.block.photons)
      sums.stored += Rgbd(double(photon.flux[0]), double(photon.flux[1]), double(photon.flux[2]));
    sums.photons.insert(sums.photons.end(), batch.block.photons.begin(), batch.block.photons.end());
    sums.emitted += batch.emitted;
    sums.escaped += batch.escaped;
    sums.absorbed += batch.absorbed;
  }
  return sums;
}

class ClosedBoxPhotons : public testing::TestWithParam<std::tuple<Shape, float>> {};

/// Seen to fail: flux not divided by the probability of survival (33 %).
TEST_P(ClosedBoxPhotons, TotalFluxIsTheGeometricSeries) {
  const auto [shape, rho] = GetParam();
  test::ClosedBox box(shape, rho);
  const SceneFrame& frame = box.scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, box.table);
  PhotonOptions options;
  options.photon_count = rho > 0.95f ? 20000 : 100000;
  const PhotonTracer photons(tracer, lights, options);
  const Sums sums = trace_all(photons);
  const double n = double(photons.photon_count()), flux = double(box.flux.g), exact = flux / (1 - double(rho));
  // Hits per path are geometric: mean 1/(1-rho), variance rho/(1-rho)^2; 4 sigma of n paths.
  EXPECT_NEAR(sums.stored.g, exact, exact * (4 * std::sqrt(double(rho) / n) + 2e-5));
  EXPECT_NEAR(sums.emitted.g, flux, 1e-5 * flux);
  EXPECT_EQ(sums.escaped.g, 0) << "a photon left a closed room";
  EXPECT_NEAR(sums.absorbed.g, sums.emitted.g - sums.escaped.g, 1e-9 * flux);
}

INSTANTIATE_TEST_SUITE_P(Rooms, ClosedBoxPhotons,
                         testing::Combine(testing::Values(Shape::cube, Shape::corridor, Shape::sphere),
                                          testing::Values(0.0f, 0.5f, 0.9f, 0.99f)));

/// A point light in the plane of a floor: the cosine is 0 and the floor gets no light, although every other photon
/// starts towards it. A light a millionth of a metre above the floor gives it half of its flux.
TEST(PhotonTracer, AFloorGetsNothingFromALightInItsPlane) {
  for (const auto& [a, b] :
       {std::pair{Vec3{1, 0, 0}, Vec3{0, 0, 1}}, std::pair{Vec3{1, 0.5f, 0.2f}, Vec3{-0.4f, 0.3f, 1}}})
    for (const float before : {0.0f, 1e-6f}) {
      test::HandMadeScene scene;
      const Vec3 middle{0.1f, 0.3f, -0.2f};
      scene.add_quad(middle - a - b, middle - a + b, middle + a + b, middle + a - b, test::matte(Rgb(0.5f)));
      scene.add_point_light(middle + normalize(cross(b, a)) * before, Rgb(1.0f));
      const SceneFrame& frame = scene.frame();
      const EmissionTable table = build_emission_table({&frame, 1});
      const Tracer tracer(frame);
      const Lights lights(frame, table);
      PhotonOptions options;
      options.photon_count = 10000;
      const Sums sums = trace_all(PhotonTracer(tracer, lights, options));
      EXPECT_NEAR(sums.emitted.g, 4 * M_PI, 1e-4);
      // Half of 10000 points of Halton's sequence: 2 % of all is four standard deviations of independent points.
      const double share = sums.stored.g / sums.emitted.g;
      if (before == 0) EXPECT_EQ(share, 0) << a.y;
      else EXPECT_NEAR(share, 0.5, 0.02) << a.y;
    }
}

TEST(PhotonTracer, APhotonDoesNotDependOnTheGroupsItIsCountedIn) {
  test::ClosedBox box(Shape::cube, 0.6f);
  const Tracer tracer(box.scene.frame());
  const Lights lights(box.scene.frame(), box.table);
  const auto sorted = [&](std::uint32_t groups) {
    PhotonOptions options;
    options.photon_count = 6300;
    options.group_count = groups;
    Sums sums = trace_all(PhotonTracer(tracer, lights, options));
    std::sort(sums.photons.begin(), sums.photons.end(), [](const auto& a, const auto& b) {
      return std::tie(a.position, a.flux, a.bounce) < std::tie(b.position, b.flux, b.bounce);
    });
    return sums.photons;
  };
  const auto one = sorted(1);
  EXPECT_EQ(one, sorted(630));
  EXPECT_EQ(one, sorted(7));
}

/// In a closed box every path leaves a photon at each of its hits: bounces 0, 1, 2 ... and then the next path.
TEST(PhotonTracer, PhotonsOfAPathFollowEachOther) {
  test::ClosedBox box(Shape::cube, 0.7f);
  const SceneFrame& frame = box.scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, box.table);
  PhotonOptions options;
  options.photon_count = 2000;
  options.group_count = 1;
  const formats::PhotonBlock block = PhotonTracer(tracer, lights, options).trace(0).block;
  ASSERT_GT(block.photons.size(), 2000u);
  int before = -1;
  for (const formats::Photon& photon : block.photons) {
    EXPECT_TRUE(photon.bounce == 0 || photon.bounce == before + 1) << int(photon.bounce) << " after " << before;
    before = photon.bounce;
  }
}

TEST(PhotonTracer, KindsLeftOutChangeNothingElse) {
  test::ClosedBox box(Shape::cube, 0.6f);
  const Tracer tracer(box.scene.frame());
  const Lights lights(box.scene.frame(), box.table);
  PhotonOptions options;
  options.photon_count = 5000;
  const Sums all = trace_all(PhotonTracer(tracer, lights, options));
  options.set_kinds("indirect");
  const Sums indirect = trace_all(PhotonTracer(tracer, lights, options));
  std::vector<formats::Photon> chosen;
  for (const auto& photon : all.photons)
    if (photon.kind == formats::PathKind::indirect) chosen.push_back(photon);
  EXPECT_EQ(indirect.photons, chosen);
  EXPECT_LT(chosen.size(), all.photons.size());
}

TEST(PhotonMap, BytesAreEqualForAnyNumberOfThreads) {
  test::ClosedBox box(Shape::corridor, 0.7f);
  const Tracer tracer(box.scene.frame());
  const Lights lights(box.scene.frame(), box.table);
  PhotonOptions options;
  options.photon_count = 200000;
  const PhotonTracer photons(tracer, lights, options);
  std::string first;
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    std::string bytes;
    write_photon_map(photons, formats::PhotonHeader(),
                     [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); },
                     {});
    if (first.empty()) first = bytes;
    EXPECT_TRUE(bytes == first) << threads << " threads";
  }
}

TEST(PhotonMap, WhereNothingIsAbsorbedTheTotalIsNotNegative) {
  // A convex white body under a sun: all light escapes. Russian roulette ends some photons and increases the flux of
  // the others, so the difference has either sign.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::HandMadeScene scene;
    scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, test::matte(Rgb(1.0f)));
    scene.add_point_light({0, 0, 1}, Rgb(1.0f));
    const EmissionTable table = build_emission_table({&scene.frame(), 1});
    const Tracer tracer(scene.frame());
    const Lights lights(scene.frame(), table);
    PhotonOptions options;
    options.photon_count = 1000;
    options.seed = seed;
    const PhotonTracer photons(tracer, lights, options);
    const auto result = write_photon_map(photons, formats::PhotonHeader(), [](const void*, std::size_t) {}, {});
    for (const double x : result.totals.absorbed_flux) EXPECT_GE(x, 0) << seed;
  }
}

TEST(PhotonOptions, UnknownKindsAreRefused) {
  PhotonOptions options;
  EXPECT_THROW(options.set_kinds("direct,shiny"), InputError);
  EXPECT_THROW(options.set_kinds(""), InputError);
  options.set_kinds("caustic");
  EXPECT_EQ(options.kinds(), "caustic");
}

}  // namespace
}  // namespace tempolux
