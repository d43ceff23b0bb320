// Photons, points, gathered records and interpolation together, against answers known on paper and path tracing.
#include "lib/render/known_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/core/sobol.h"
#include "lib/gather/irradiance_points.h"
#include "lib/render/path_tracer.h"
#include "tests/support/closed_box.h"
#include "tests/support/photons.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::Shape;

struct Traced {
  std::vector<formats::Photon> photons;
  double stored_indirect = 0;   ///< W, green
};

Traced trace(const Tracer& tracer, const Lights& lights, std::uint64_t count) {
  PhotonOptions options;
  options.photon_count = count;
  options.store_direct = false;
  const PhotonTracer photons(tracer, lights, options);
  Traced traced;
  for (const formats::Photon& photon : test::photons_of(photons)) {
    traced.photons.push_back(photon);
    traced.stored_indirect += double(photon.flux[1]);
  }
  return traced;
}

/// A scene with its photons, points and a gather.
struct Chain {
  const SceneFrame& frame;
  EmissionTable table;
  Tracer tracer;
  Lights lights;
  Traced traced;
  PointOptions point_options;
  PlacedPoints placed;
  PointLookup lookup;
  FinalGather gather;
  RecordStore store;

  Chain(HandMadeScene& scene, std::uint64_t photons, std::uint32_t point_count, int rays, int light_samples = 4)
      : frame(scene.frame()), table(build_emission_table({&frame, 1})), tracer(frame), lights(frame, table),
        traced(trace(tracer, lights, photons)), point_options(counted(point_count, light_samples)), placed(estimated()),
        lookup(placed.points, placed.spacing, point_clearance(tracer)),
        gather(tracer, lights, lookup, with_rays(rays)), store() {}

  /// Records for a picture whose pixel i sees `at(i)`, seen from the side of the normal given.
  template <class At>
  void place(int width, int height, float footprint, const At& at) {
    GatherCounts counts;
    const PixelView view = [&](float x, float y, const PathRandom*) -> std::optional<SeenPoint> {
      const std::optional<std::pair<SurfacePoint, Vec3>> seen = at(std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x));
      if (!seen) return std::nullopt;
      return SeenPoint{seen->first, seen->second, footprint, false};
    };
    place_records(gather, view, width, height, {}, store, counts);
    EXPECT_LT(counts.unanswered, counts.rays / 20);   // next to walls and where surfaces bend
  }
  /// The surface under `position`, met from h above it.
  std::optional<std::pair<SurfacePoint, Vec3>> surface_at(Vec3 position, Vec3 normal, float h) const {
    Hit hit;
    if (!tracer.intersect({position + normal * h, -normal}, hit)) return std::nullopt;
    return std::pair{tracer.surface_point(hit), normal};
  }

 private:
  static PointOptions counted(std::uint32_t count, int light_samples) {
    PointOptions options;
    options.count = count;
    options.light_samples = light_samples;
    return options;
  }
  static GatherOptions with_rays(int rays) {
    GatherOptions options;
    options.rays = rays;
    return options;
  }
  PlacedPoints estimated() {
    PlacedPoints made = place_points(frame, point_options);
    estimate_points(tracer, lights, traced.photons, {}, point_options, made.points);
    return made;
  }
};

class ClosedBoxCache : public testing::TestWithParam<std::tuple<Shape, float>> {};

/// Mean indirect irradiance F rho / (S (1 - rho)). What n paths leave behind scatters by sqrt(rho / n) about that
/// series (photon_trace_test checks it): divided out, for what is gathered is rho (F + stored) / S with those photons.
/// 2048 places spread evenly leave less than 0.3 % of the field's variation; 4 shadow rays at 2 x 5000 points,
/// the gather of 300 rays a record and the points' own 50 neighbours each less than 0.2 %: 1 % is 3 sigma or more.
TEST_P(ClosedBoxCache, MeanIndirectIrradiance) {
  const auto [shape, rho] = GetParam();
  test::ClosedBox box(shape, rho);
  Chain chain(box.scene, rho > 0.95f ? 4000 : rho > 0.8f ? 40000 : 100000, 5000, 300);
  const test::AreaSampler area(chain.frame);
  constexpr int kWidth = 64, kHeight = 32;
  const auto at = [&](std::uint32_t i) {
    Vec3 p, n;
    area.sample((float(i) + 0.5f) / (kWidth * kHeight), sobol_owen_2d(i, 5), p, n);
    return chain.surface_at(p, n, 0.01f);
  };
  chain.place(kWidth, kHeight, 0.25f * float(std::sqrt(area.area() / (kWidth * kHeight))), at);
  double sum = 0;
  int count = 0;
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i)
    if (const auto seen = at(i)) {
      const auto found = chain.store.interpolate(seen->first.position, seen->second);
      ASSERT_GT(found.weight, 0);
      sum += double(found.irradiance.g);
      ++count;
    }
  ASSERT_GT(count, kWidth * kHeight * 99 / 100);
  const double flux = double(box.flux.g), exact = flux * double(rho) / (area.area() * (1 - double(rho)));
  const double given_photons = double(rho) * (flux + chain.traced.stored_indirect) / area.area();
  if (rho == 0) {
    EXPECT_EQ(sum, 0);
    return;
  }
  EXPECT_NEAR(sum / count / given_photons, 1, 0.01);
  const double paths = rho > 0.95f ? 4000 : rho > 0.8f ? 40000 : 100000;
  EXPECT_NEAR(given_photons / exact, 1, 4 * std::sqrt(double(rho) / paths) + 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Rooms, ClosedBoxCache,
                         testing::Combine(testing::Values(Shape::cube, Shape::corridor, Shape::sphere),
                                          testing::Values(0.0f, 0.5f, 0.9f, 0.99f)));

/// A furnace: every wall emits 1 and reflects rho, E = pi/(1 - rho) in all, pi rho/(1 - rho) of it indirect.
/// Light from walls beside a point varies by far more than its mean between places on them: 16 shadow rays (with 4 a
/// seed is 0.7 % off now and then).
TEST(FurnaceCache, IndirectIrradianceIsUniform) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f), Rgb(1.0f)));
  Chain chain(scene, 400000, 3000, 300, 16);
  const test::AreaSampler area(chain.frame);
  const auto at = [&](std::uint32_t i) {
    Vec3 p, n;
    area.sample((float(i) + 0.5f) / 512, sobol_owen_2d(i, 5), p, n);
    return chain.surface_at(p, n, 0.01f);
  };
  chain.place(32, 16, 0.02f, at);
  double sum = 0;
  for (std::uint32_t i = 0; i < 512; ++i) {
    const auto seen = at(i);
    ASSERT_TRUE(seen);
    sum += double(chain.store.interpolate(seen->first.position, seen->second).irradiance.g);
  }
  EXPECT_NEAR(sum / 512 / M_PI, 1, 0.005);
}

/// Indirect irradiance at a point by path tracing: what cosine-distributed rays bring, seen light left out.
double path_traced(const Chain& chain, const SurfacePoint& from, Vec3 normal, int paths) {
  const RenderScene scene{chain.tracer, chain.lights};
  const Frame frame(normal);
  RayCounts counts;
  double sum = 0;
  for (int i = 0; i < paths; ++i) {
    const PixelRandom random(99, std::uint64_t(std::abs(from.position.x) * 1e6f), std::uint32_t(i));
    const Vec3 wi = frame.to_world(sample_hemisphere_cos(sobol_owen_2d(std::uint32_t(i), 17)));
    const Layers seen = trace_eye_path(scene, spawn_ray(from, wi), random, nullptr, counts);
    sum += double(seen[Layer::direct].g + seen[Layer::indirect].g + seen[Layer::caustic].g);
  }
  return M_PI * sum / paths;
}

/// A partition 1 cm thick on the floor of a room, open above; the lamp stands low on one side, 1 m from it. At the
/// foot of the dark side 1 to 8 cm from the partition nothing of the bright side's light may come through, nor in
/// the strip as near on the bright side be lost: both within 3 % of path tracing (16 places x 4096 paths: 0.7 %;
/// photons and points of one seed: 1 %).
TEST(CacheLeaks, ThinPartitionOnAFloor) {
  HandMadeScene scene;
  const Material grey = matte(Rgb(0.6f));
  scene.add_room({-1, -1, -1}, {1, 1, 1}, grey);
  const float t = 0.005f, top = 0.4f;
  scene.add_quad({t, -1, -1}, {t, top, -1}, {t, top, 1}, {t, -1, 1}, grey);
  scene.add_quad({-t, -1, -1}, {-t, -1, 1}, {-t, top, 1}, {-t, top, -1}, grey);
  scene.add_quad({-t, top, -1}, {-t, top, 1}, {t, top, 1}, {t, top, -1}, grey);
  scene.add_point_light({-0.9f, -0.5f, 0.1f}, Rgb(1.0f));
  Chain chain(scene, 400000, 20000, 800);
  for (float side : {-1.0f, 1.0f}) {
    const auto at = [&](std::uint32_t i) {
      const Vec2 u = sobol_owen_2d(i, 3);
      return chain.surface_at({side * (t + 0.005f + 0.2f * u.x), -1, 1.6f * u.y - 0.8f}, {0, 1, 0}, 0.01f);
    };
    chain.place(32, 32, 0.002f, at);
  }
  for (float side : {-1.0f, 1.0f}) {
    double cached = 0, exact = 0;
    for (int i = 0; i < 16; ++i) {
      const auto seen = chain.surface_at({side * (t + 0.01f + 0.005f * float(i)), -1, 0.1f * float(i) - 0.75f}, {0, 1, 0}, 0.01f);
      ASSERT_TRUE(seen);
      const auto found = chain.store.interpolate(seen->first.position, seen->second);
      const auto near = found.weight > 0 ? found : chain.store.interpolate_relaxed(seen->first.position, seen->second);
      ASSERT_GT(near.weight, 0);
      cached += double(near.irradiance.g);
      exact += path_traced(chain, seen->first, seen->second, 4096);
    }
    EXPECT_NEAR(cached / exact, 1, 0.03) << (side < 0 ? "bright" : "dark") << " side: " << exact / 16;
  }
}

/// Where no record is, one is gathered, once asked for; where the gather has nothing to read there is no light.
TEST(CacheLight, MissingRecordsAreGatheredAndCounted) {
  test::ClosedBox box(Shape::cube, 0.5f);
  Chain chain(box.scene, 20000, 2000, 300);
  int asked = 0;
  const CacheLight light(chain.store, [&] { ++asked; return &chain.gather; }, nullptr);
  const auto seen = chain.surface_at({0.3f, -1, 0.2f}, {0, 1, 0}, 0.01f);
  ASSERT_TRUE(seen);
  const auto first = light.at(seen->first, {0, 1, 0}, {0, 1, 0}, true, nullptr), second = light.at(seen->first, {0, 1, 0}, {0, 1, 0}, true, nullptr);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(light.gathered_on_the_spot(), 2u);
  EXPECT_EQ(first.indirect, second.indirect);
  EXPECT_GT(first.indirect.g, 0);
  GatherCounts counts;
  IrradianceRecord record = chain.gather.gather(seen->first, {0, 1, 0}, counts);
  EXPECT_EQ(record.irradiance, first.indirect);
  record.radius = 0.1f;
  chain.store.add(record);
  EXPECT_EQ(light.at(seen->first, {0, 1, 0}, {0, 1, 0}, true, nullptr).indirect, record.irradiance);
  EXPECT_EQ(light.gathered_on_the_spot(), 2u);

  const RecordStore none;
  const CacheLight dark(none, [] { return nullptr; }, nullptr);
  EXPECT_EQ(dark.at(seen->first, {0, 1, 0}, {0, 1, 0}, true, nullptr).indirect, Rgb(0.0f));
  EXPECT_EQ(dark.gathered_on_the_spot(), 1u);
}

/// A record whose radius ends short of a place speaks for it where it is seen directly: it is of the same pixel or the next.
/// Through glass or gloss it may be anything, the ground under a ball of glass for what is inside, and is not asked.
TEST(CacheLight, RecordsThatEndShortCountInDirectViewOnly) {
  test::ClosedBox box(Shape::cube, 0.5f);
  Chain chain(box.scene, 20000, 2000, 300);
  const CacheLight light(chain.store, [&] { return &chain.gather; }, nullptr);
  const auto seen = chain.surface_at({0.3f, -1, 0.2f}, {0, 1, 0}, 0.01f), beside = chain.surface_at({0.1f, -1, 0.2f}, {0, 1, 0}, 0.01f);
  ASSERT_TRUE(seen && beside);
  GatherCounts counts;
  const Rgb own = chain.gather.gather(seen->first, {0, 1, 0}, counts).irradiance;
  IrradianceRecord other = chain.gather.gather(beside->first, {0, 1, 0}, counts);
  other.irradiance = Rgb(1000.0f);
  other.translational = {};
  other.radius = 0.1f;   // 0.2 away
  chain.store.add(other);
  EXPECT_NEAR(light.at(seen->first, {0, 1, 0}, {0, 1, 0}, true, nullptr).indirect.g, 1000, 1e-3f);
  EXPECT_EQ(light.gathered_on_the_spot(), 0u);
  EXPECT_EQ(light.at(seen->first, {0, 1, 0}, {0, 1, 0}, false, nullptr).indirect, own);
  EXPECT_EQ(light.gathered_on_the_spot(), 1u);
}

}  // namespace
}  // namespace tempolux
