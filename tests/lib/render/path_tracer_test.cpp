// The path tracer against answers known on paper.
#include "lib/render/path_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/closed_box.h"
#include "tests/support/layers.h"
#include "tests/support/mean.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::Mean;
using test::Shape;
using test::total;

class ClosedBoxTest : public testing::TestWithParam<std::tuple<Shape, float>> {};

/// Radiance that arrives at uniform points of the walls from cosine-distributed directions, times pi, is the
/// mean irradiance after at least one reflection (a ray never meets the point light itself).
TEST_P(ClosedBoxTest, MeanIndirectIrradianceIsTheGeometricSeries) {
  const auto [shape, rho] = GetParam();
  test::ClosedBox box(shape, rho);
  const SceneFrame& frame = box.scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, box.table);
  const test::AreaSampler area(frame);
  RayCounts counts;
  Mean green;
  const int paths = rho > 0.95f ? 20000 : 40000;
  for (int i = 0; i < paths; ++i) {
    const PathRandom random(11, std::uint64_t(i));
    SurfacePoint from;
    area.sample(random.get1(0, Purpose::test), random.get2(1, Purpose::test), from.position, from.normal_geometric);
    from.normal = from.normal_geometric;
    from.offset = 1e-5f;
    const Vec3 travel = Frame(from.normal).to_world(sample_hemisphere_cos(random.get2(2, Purpose::test)));
    const Layers seen =
        trace_eye_path({tracer, lights}, spawn_ray(from, travel), PixelRandom(3, std::uint64_t(i), 0), nullptr, counts);
    green.add(double(kPi) * total(seen, 1));
  }
  const double expected = double(box.flux.g) * double(rho) / (area.area() * (1 - double(rho)));
  // 4 sigma of the estimate itself; sigma is checked to be small enough to notice a lost percent or two.
  EXPECT_NEAR(green.mean(), expected, 4 * green.sigma() + 1e-12) << test::name_of(shape) << " rho " << rho;
  EXPECT_LE(green.sigma(), 0.012 * expected + 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Rooms, ClosedBoxTest,
                         testing::Combine(testing::Values(Shape::cube, Shape::corridor, Shape::sphere),
                                          testing::Values(0.0f, 0.5f, 0.9f, 0.99f)));

/// Every surface emits Le and reflects rho: radiance Le / (1 - rho) in every direction from everywhere.
TEST(PathTracer, FurnaceIsUniform) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f, 0.8f, 0.2f), Rgb(1.0f)));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  RayCounts counts;
  Mean mean[3];
  for (int i = 0; i < 60000; ++i) {
    const Vec3 travel = test::sample_sphere(PathRandom(1, std::uint64_t(i)).get2(0, Purpose::test));
    const Layers seen = trace_eye_path({tracer, lights}, {{0.3f, -0.2f, 0.1f}, travel, 0, INFINITY},
                                       PixelRandom(7, std::uint64_t(i), 0), nullptr, counts);
    for (int c = 0; c < 3; ++c) mean[c].add(total(seen, c));
  }
  const double expected[3] = {2.0, 5.0, 1.25};
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c].mean(), expected[c], 4 * mean[c].sigma()) << c;
    EXPECT_LT(mean[c].sigma(), 0.005 * expected[c]) << c;
  }
}

TEST(EyePath, LayersFollowTheEvents) {
  const auto layer = [](std::initializer_list<bool> diffuse) {
    EyePath path;
    for (bool d : diffuse) path.scatter(d);
    return path.layer();
  };
  constexpr bool D = true, S = false;
  EXPECT_EQ(layer({}), Layer::emission);
  EXPECT_EQ(layer({D}), Layer::direct);
  EXPECT_EQ(layer({S}), Layer::specular);
  EXPECT_EQ(layer({S, D}), Layer::specular);
  EXPECT_EQ(layer({S, D, D}), Layer::specular);
  EXPECT_EQ(layer({D, S}), Layer::caustic);
  EXPECT_EQ(layer({D, S, S}), Layer::caustic);
  EXPECT_EQ(layer({D, D}), Layer::indirect);
  EXPECT_EQ(layer({D, S, D}), Layer::indirect);
  EXPECT_EQ(layer({D, D, S}), Layer::indirect);
}

/// A point light I at height h over a Lambertian plane: L = albedo/pi I cos/d^2, exactly, for every sample.
TEST(PathTracer, PlaneUnderAPointLightIsExact) {
  HandMadeScene scene;
  scene.add_quad({-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}, matte(Rgb(0.5f, 0.25f, 0.75f)));
  scene.add_point_light({0, 2, 0}, Rgb(10.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  RayCounts counts;
  for (float x : {0.0f, 0.7f, 3.0f}) {
    const Ray ray{{x, 4, 0.1f}, {0, -1, 0}, 0, INFINITY};
    const Layers seen = trace_eye_path({tracer, lights}, ray, PixelRandom(0, 0, 0), nullptr, counts);
    const double d2 = 4 + double(x) * double(x) + 0.01, expected = 0.5 / M_PI * 10 * 2 / std::sqrt(d2) / d2;
    EXPECT_NEAR(double(seen[Layer::direct].r), expected, 1e-5 * expected);
    EXPECT_NEAR(total(seen, 0), double(seen[Layer::direct].r), 0);
  }
}

}  // namespace
}  // namespace tempolux
