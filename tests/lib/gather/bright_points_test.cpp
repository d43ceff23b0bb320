// Bright points sampled explicitly: form factors, the sum with the light of rays, gradients, limits.
#include "lib/gather/bright_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/gather/final_gather.h"
#include "lib/points/irradiance_points.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::place_at;

const Lights& no_lights(const SceneFrame& frame) {
  thread_local std::vector<std::unique_ptr<Lights>> kept;
  return *kept.emplace_back(std::make_unique<Lights>(frame, EmissionTable{}));
}

/// A square patch with edges of 1 m, represented by one point (spacing 1 m, R = 0.564 m), at height h above a floor. It
/// emits radiance 1 downwards.
struct Patch {
  HandMadeScene scene;
  std::vector<IrradiancePoint> points;
  double height;
  explicit Patch(double h) : height(h) {
    const auto y = float(h);
    scene.add_quad({-0.5f, y, -0.5f}, {0.5f, y, -0.5f}, {0.5f, y, 0.5f}, {-0.5f, y, 0.5f}, matte(Rgb(1.0f)));
    IrradiancePoint point;
    point.position = {0, y, 0};
    point.normal = {0, -1, 0};
    point.indirect = Rgb(kPi);
    points.push_back(point);
  }
  /// Irradiance at (x, 0, 0), normal up: integral of cos cos / l^2 over the patch, by midpoints.
  double exact(double x) const {
    constexpr int n = 200;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double dx = (i + 0.5) / n - 0.5 - x, dz = (j + 0.5) / n - 0.5, l2 = dx * dx + dz * dz + height * height;
        sum += height * height / (l2 * l2) / (n * n);
      }
    return sum;
  }
};

/// The irradiance of the patch at a point: within 1 % for l >= 5 R, within 5 % in the fade from 4 R to 6 R. Sixteen
/// sites integrate the patch to a fraction of a per cent. In the fade rays contribute a part: of 300 gathers x 2000
/// rays some 600000 x (form factor / pi) = 10000 rays meet the patch at 5 R, an error of 1 %, and less because rays are
/// stratified by cells. Seen to fail: the cosine at the patch left out (30 %).
TEST(BrightPoints, FormFactorOfAPatch) {
  const double R = 1 / std::sqrt(M_PI);
  for (const double l : {4.2, 4.6, 5.0, 5.5, 6.5, 10.0})
    for (const double x : {0.0, 2.0}) {
      Patch patch(l * R);
      const Tracer tracer(patch.scene.frame());
      const Lights& lights = no_lights(patch.scene.frame());
      const PointLookup lookup(patch.points, 1);
      const SurfacePoint from = place_at({float(x), 0, 0}, {0, 1, 0});
      double with_rays = 0, alone = 0;
      constexpr int kGathers = 300;
      for (int r = 0; r < kGathers; ++r) {
        const BrightPoints bright(tracer, lights, lookup, {1.0f}, {.seed = std::uint64_t(r)});
        ASSERT_EQ(bright.spot_count(), 1u);
        GatherCounts counts;
        if (l < 6)
          with_rays +=
              double(FinalGather(tracer, lights, lookup,
                                 {.seed = std::uint64_t(r), .rays = 2000, .bright = &bright, .bright_samples = 16})
                         .gather(from, {0, 1, 0}, counts)
                         .irradiance.g) /
              kGathers;
        alone +=
            bright.arriving({from, {0, 1, 0}}, 16, PathRandom(1, std::uint64_t(r)), counts).irradiance.g / kGathers;
      }
      const double exact = patch.exact(x);
      if (l < 6) {
        EXPECT_NEAR(with_rays / exact, 1, l < 5 ? 0.05 : 0.01) << l << " R, aside " << x;
        if (x == 0) { EXPECT_LT(alone, exact); }
      } else {
        EXPECT_NEAR(alone / exact, 1, 0.01) << l << " R, aside " << x;
      }
    }
}

/// Means of groups, and the standard error of their mean.
struct Groups {
  std::vector<double> means;
  double mean() const {
    double sum = 0;
    for (const double m : means) sum += m;
    return sum / double(means.size());
  }
  double error2() const {
    double squares = 0;
    for (const double m : means) squares += (m - mean()) * (m - mean());
    return squares / double(means.size() - 1) / double(means.size());
  }
};

/// A box with a block in it: corners, close hits, and an obstacle. Points have random light and random high shares. For
/// any values, the light of rays plus explicit samples must equal the light of rays alone. Twelve sets of sites with 12
/// gathers each; the difference is within 5 standard errors at each of 5 places (with 11 degrees of freedom: exceeded
/// once in 2000), with shares from 0 to 1, and with shares of 1. If explicit samples left out close hits, or counted
/// them in full, the difference in the corner would be 8 and 12 standard errors. Seen to fail: close light counted by
/// rays and by explicit samples.
TEST(BrightPoints, PartsAddUpToTheWhole) {
  HandMadeScene scene;
  scene.add_room({0, 0, 0}, {2, 1, 1}, matte(Rgb(0.7f)));
  scene.add_room({1.3f, 0.6f, 0.7f}, {0.9f, 0.2f, 0.3f},
                 matte(Rgb(0.4f, 0.5f, 0.6f)));  // corners the other way round: fronts outwards
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights& lights = no_lights(frame);
  PlacedPoints placed = place_points(frame, {.seed = 3, .count = 600});
  std::array<std::vector<float>, 3> shares;  // none, some, all
  for (std::uint32_t i = 0; i < placed.points.size(); ++i) {
    const PathRandom random(17, i);
    IrradiancePoint& point = placed.points[i];
    point.radius = 0.1f;
    point.indirect = Rgb(random.get1(0, Purpose::test) < 0.05f ? 50.0f : 1.0f);
    shares[1].push_back(random.get1(1, Purpose::test) < 0.5f ? random.get1(2, Purpose::test) : 0.0f);
    shares[2].push_back(1);
  }
  const PointLookup lookup(placed.points, placed.spacing, point_clearance(tracer));
  const std::vector<std::pair<Vec3, Vec3>> places{{{0.3f, 0, 0.5f}, {0, 1, 0}},
                                                  {{0.02f, 0, 0.03f}, {0, 1, 0}},
                                                  {{2, 0.5f, 0.5f}, {-1, 0, 0}},
                                                  {{1.1f, 0.601f, 0.5f}, {0, 1, 0}},
                                                  {{1.6f, 1, 0.9f}, {0, -1, 0}}};
  constexpr int kGroups = 12, kGathers = 12;
  std::vector<std::array<Groups, 3>> found(places.size());
  for (int g = 0; g < kGroups; ++g)
    for (std::size_t k = 0; k < 3; ++k) {
      std::optional<BrightPoints> bright;
      if (k > 0) bright.emplace(tracer, lights, lookup, shares[k], BrightOptions{.seed = std::uint64_t(g)});
      for (std::size_t p = 0; p < places.size(); ++p) {
        double sum = 0;
        for (int r = 0; r < kGathers; ++r) {
          const FinalGather gather(
              tracer, lights, lookup,
              {.seed = std::uint64_t(g * kGathers + r), .rays = 200, .bright = bright ? &*bright : nullptr});
          GatherCounts counts;
          sum +=
              double(gather.gather(place_at(places[p].first, places[p].second), places[p].second, counts).irradiance.g);
        }
        found[p][k].means.push_back(sum / kGathers);
      }
    }
  for (std::size_t p = 0; p < places.size(); ++p)
    for (std::size_t k = 1; k < 3; ++k)
      EXPECT_NEAR(found[p][k].mean(), found[p][0].mean(), 5 * std::sqrt(found[p][0].error2() + found[p][k].error2()))
          << p << " " << k;
}

/// A single spot is drawn with certainty, by the same sites for the same random numbers, so differences of the estimate
/// are those of the integrand. Steps of 1 mm at a distance of 4 m: errors of second order are 1e-3. Seen to fail: a
/// factor 2 in place of 4 for the gradient of 1 / d^4.
TEST(BrightPoints, GradientsAreDifferences) {
  Patch patch(4);
  const Tracer tracer(patch.scene.frame());
  const PointLookup lookup(patch.points, 1);
  const BrightPoints bright(tracer, no_lights(patch.scene.frame()), lookup, {1.0f}, {});
  GatherCounts counts;
  const auto at = [&](Vec3 position, Vec3 normal) {
    return bright.arriving({place_at(position, normal), normal}, 64, PathRandom(1, 2), counts);
  };
  const Vec3 x{1.5f, 0, 0.5f}, up{0, 1, 0};
  const BrightLight here = at(x, up);
  constexpr float h = 1e-2f;
  for (const Vec3 along : {Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
    const double difference =
        (at(x + along * h, up).irradiance.g - at(x - along * h, up).irradiance.g) / (2 * double(h));
    EXPECT_NEAR(dot(here.translational[1], Vec3d(along)), difference, 2e-3 * here.irradiance.g);
    const Vec3 tilted = normalize(up + along * h), other = normalize(up - along * h);
    const double turned = (at(x, tilted).irradiance.g - at(x, other).irradiance.g) / (2 * double(h));
    EXPECT_NEAR(dot(here.rotational[1], Vec3d(cross(up, along))), turned, 2e-3 * here.irradiance.g);
  }
}

/// If no point has a high part, nothing is sampled, and rays have the same bits. If an obstacle lies in between, no
/// light arrives.
TEST(BrightPoints, NothingHighAndNothingSeen) {
  Patch patch(4);
  const Lights& lights = no_lights(patch.scene.frame());
  {
    const Tracer tracer(patch.scene.frame());
    const PointLookup lookup(patch.points, 1);
    const BrightPoints none(tracer, lights, lookup, {0.0f}, {});
    EXPECT_EQ(none.spot_count(), 0u);
    const SurfacePoint from = place_at({0, 0, 0}, {0, 1, 0});
    GatherCounts counts;
    const IrradianceRecord plain = FinalGather(tracer, lights, lookup, {.rays = 100}).gather(from, {0, 1, 0}, counts);
    const IrradianceRecord same =
        FinalGather(tracer, lights, lookup, {.rays = 100, .bright = &none}).gather(from, {0, 1, 0}, counts);
    EXPECT_EQ(plain.irradiance.g, same.irradiance.g);
    EXPECT_EQ(plain.translational[1].x, same.translational[1].x);
  }
  patch.scene.add_quad({-3, 2, -3}, {3, 2, -3}, {3, 2, 3}, {-3, 2, 3}, matte(Rgb(0.0f)));
  const Tracer tracer(patch.scene.frame());
  const PointLookup lookup(patch.points, 1);
  const BrightPoints bright(tracer, lights, lookup, {1.0f}, {});
  GatherCounts counts;
  EXPECT_EQ(bright.arriving({place_at({0, 0, 0}, {0, 1, 0}), {0, 1, 0}}, 64, PathRandom(1, 2), counts).irradiance.g, 0);
  EXPECT_EQ(counts.shadow_rays, 64u);  // each sample drew the only spot
}

}  // namespace
}  // namespace tempolux
