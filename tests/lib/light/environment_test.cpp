// The environment as a light: which pixel is where, sampling that matches the look-up, closed forms, emission.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "lib/core/halton.h"
#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "tests/lib/light/light_scene.h"

namespace tempolux {
namespace {

constexpr double kPiD = std::numbers::pi;

using Paint = std::function<Rgb(int x, int y)>;

Environment painted(int width, int height, const Paint& paint, double rotation_deg = 0) {
  Environment environment;
  environment.width = width;
  environment.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) environment.radiance.push_back(paint(x, y));
  environment.rotation_rad = rotation_deg * kPiD / 180;
  return environment;
}

Paint one_bright(int bx, int by) {
  return [=](int x, int y) { return Rgb(x == bx && y == by ? 1.0f : 0.0f); };
}

/// A sky with blobs, black parts and a sun of 10^4.
Rgb sky(int x, int y) {
  if (y > 9) return Rgb(0.0f);
  if (x == 5 && y == 3) return Rgb(1e4f, 8e3f, 6e3f);
  return Rgb(0.2f + 0.1f * float(x % 3), 0.3f, 0.1f * float(y));
}

/// Irradiance at a point without occlusion, by light sampling: the mean of n samples.
double sampled_irradiance(const Lights& lights, Vec3 normal, int n, std::uint64_t seed) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    LightSample s;
    const PathRandom random(seed, std::uint64_t(i));
    if (!lights.sample({}, normal, random.get2(0, Purpose::light_point), s)) continue;
    sum += double(s.facing_irradiance.g) * std::max(0.0f, dot(s.wi, normal));
  }
  return sum / n;
}

// The brightest direction is the centre of the pixel that is painted. Of a map of 64 x 32: longitude 0 (+Z) lies
// between columns 31 and 32, pi/2 (+X) between 15 and 16, -pi/2 (-X) between 47 and 48, pi (-Z) at the outer edges.
TEST(EnvironmentAxes, TheMiddleIsPlusZItsLeftIsPlusXTheTopIsPlusY) {
  struct Case {
    int x, y;
    Vec3 axis;
  };
  for (const auto& [x, y, axis] :
       {Case{31, 15, {0, 0, 1}}, Case{32, 16, {0, 0, 1}}, Case{15, 15, {1, 0, 0}}, Case{16, 16, {1, 0, 0}},
        Case{47, 15, {-1, 0, 0}}, Case{0, 16, {0, 0, -1}}, Case{63, 15, {0, 0, -1}}}) {
    const Environment map = painted(64, 32, one_bright(x, y));
    EXPECT_NEAR(EnvironmentLight(map).radiance(axis).g, 0.25, 1e-5) << x << ' ' << y;  // of four pixels around it
  }
  // Column 30 lies at longitude +1.5 pixels, towards +X: this decides which side is left.
  const double off = 1.5 * 2 * kPiD / 64, low = 0.5 * kPiD / 32;
  const Environment left = painted(64, 32, one_bright(30, 15));
  const Vec3 towards(Vec3d{std::sin(off) * std::cos(low), std::sin(low), std::cos(off) * std::cos(low)});
  EXPECT_NEAR(EnvironmentLight(left).radiance(towards).g, 1, 1e-5);
  const Environment top = painted(64, 32, [](int, int y) { return Rgb(y == 0 ? 1.0f : 0.0f); });
  EXPECT_EQ(EnvironmentLight(top).radiance({0, 1, 0}).g, 1);
  EXPECT_EQ(EnvironmentLight(top).radiance({0, -1, 0}).g, 0);
}

// The worked example of formats/conventions.md: the irradiance is 2 x 2 pi / w x int hat(t) sin t cos t dt. Taking
// the sine at the pixel's centre has an error of 0.3 %.
TEST(EnvironmentAxes, TheWorkedExample) {
  const Environment map = painted(64, 32, [](int x, int y) { return Rgb(x == 16 && y == 8 ? 2.0f : 0.0f); });
  EXPECT_NEAR(EnvironmentLight(map).radiance({0.7401f, 0.6716f, 0.0364f}).g, 2, 0.01);
  LightScene scene;
  scene.frame.environment = &map;
  EXPECT_NEAR(sampled_irradiance(scene.lights(), {0, 1, 0}, 1 << 14, 1), 2 * 0.6716 * 7.14e-3, 0.005 * 0.0096);
}

TEST(EnvironmentAxes, RotationTurnsPlusZToPlusX) {
  const Environment map = painted(64, 32, one_bright(31, 15), 90);
  const EnvironmentLight light(map);
  EXPECT_NEAR(light.radiance({1, 0, 0}).g, 0.25, 1e-5);
  EXPECT_EQ(light.radiance({0, 0, 1}).g, 0);
  EnvironmentLight::Sample sample;
  ASSERT_TRUE(light.sample(0.5, 0.5, sample));
  EXPECT_GT(sample.direction.x, 0.98f);
}

TEST(EnvironmentIntegral, IsFourPiForOneEverywhereAndTheHatOfAPixel) {
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 1}, {7, 5}, {64, 32}}) {
    const Environment white = painted(w, h, [](int, int) { return Rgb(1.0f); });
    EXPECT_NEAR(EnvironmentLight(white).integral().g, 4 * kPiD, 1e-12) << w << 'x' << h;
  }
  // One pixel at polar angle t, not at a pole: 2 pi / w times int hat sin = sin t (2 - 2 cos D) / D, D = pi / h.
  const Environment map = painted(64, 32, one_bright(9, 12));
  const double d = kPiD / 32, t = 12.5 * d;
  EXPECT_NEAR(EnvironmentLight(map).integral().g, 2 * kPiD / 64 * std::sin(t) * (2 - 2 * std::cos(d)) / d, 1e-12);
}

// For any f, the mean of f L / pdf is the integral of f L. f = 1 has a closed form; f = 1 / L gives the solid angle
// in which L is not 0. The pdf that sample() returns equals pdf_solid_angle(), up to the rounding of the direction to
// float32.
TEST(EnvironmentSampling, MatchesWhatIsLookedUp) {
  const std::vector<std::pair<Environment, double>> maps{
      {painted(1, 1, [](int, int) { return Rgb(2.0f); }), 4 * kPiD},
      {painted(16, 12, sky, 33), 2 * kPiD * (1 + std::cos(kPiD - 1.5 * kPiD / 12))},  // black below row 10's centre
      {painted(16, 12, one_bright(15, 0)), 2 * 2 * kPiD / 16 * (1 - std::cos(1.5 * kPiD / 12))},
      {painted(16, 12, one_bright(0, 11)), 2 * 2 * kPiD / 16 * (1 - std::cos(1.5 * kPiD / 12))}};
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const EnvironmentLight light(maps[m].first);
    const PhotonHalton halton(3);
    constexpr int kCount = 1 << 16;
    double sum = 0, area = 0;
    for (int i = 0; i < kCount; ++i) {
      const auto u = halton.point(std::uint64_t(i));
      EnvironmentLight::Sample s;
      ASSERT_TRUE(light.sample(u[0], u[1], s));
      sum += luminance(Rgbd(s.radiance)) / s.pdf_solid_angle;
      // A direction in float32 has an error of 6e-8 rad, 4e-7 of a cell, across which the radiance may change
      // completely.
      const float near = 1e-4f * s.radiance.g + 1e-6f * (m == 1 ? 1e4f : 1.0f);
      EXPECT_NEAR(light.radiance(s.direction).g, s.radiance.g, near);
      if (s.radiance.g > 0.01f) {
        EXPECT_NEAR(light.pdf_solid_angle(light.place_of(s.direction), s.direction), s.pdf_solid_angle,
                    2e-3 * s.pdf_solid_angle)
            << m;
      }
      area += 1 / s.pdf_solid_angle;
    }
    // L / pdf is constant except for the sine within a cell (12 rows: +-2 %), so Halton points leave 1e-4 of the sum.
    EXPECT_NEAR(sum / kCount, luminance(light.integral()), 3e-4 * luminance(light.integral())) << m;
    // The estimate of the area depends on samples where L is small. With a sun, which takes nearly all samples, too
    // few remain.
    if (m != 1) { EXPECT_NEAR(area / kCount, maps[m].second, 0.03 * maps[m].second) << m; }
  }
}

// pdf integrates to 1 over the sphere (a fine grid), and vanishes only where the map is black.
TEST(EnvironmentSampling, DensityIntegratesToOne) {
  const Environment map = painted(16, 12, sky, 33);
  const EnvironmentLight light(map);
  constexpr int kRows = 1200, kColumns = 1600;
  double sum = 0;
  for (int j = 0; j < kRows; ++j)
    for (int k = 0; k < kColumns; ++k) {
      const double cosine = 1 - 2 * (j + 0.5) / kRows, sine = std::sqrt(1 - cosine * cosine);
      const double phi = 2 * kPiD * (k + 0.5) / kColumns;
      const Vec3 d(Vec3d{sine * std::sin(phi), cosine, sine * std::cos(phi)});
      const double pdf = light.pdf_solid_angle(light.place_of(d), d);
      sum += pdf;
      ASSERT_EQ(pdf > 0, max_component(light.radiance(d)) > 0) << j << ' ' << k;
    }
  EXPECT_NEAR(sum * 4 * kPiD / (kRows * kColumns), 1, 2e-3);
}

TEST(EnvironmentSampling, NothingFromBlack) {
  const Environment map = painted(4, 2, [](int, int) { return Rgb(0.0f); });
  const EnvironmentLight light(map);
  EnvironmentLight::Sample sample;
  EXPECT_FALSE(light.sample(0.3, 0.7, sample));
  EXPECT_EQ(light.pdf_solid_angle(light.place_of({0, 1, 0}), {0, 1, 0}), 0);
}

// A sun of 10^4 times the sky fills four pixels at 45 degrees. The error of independent samples falls as 1/sqrt(n)
// from 4 to 256 samples. With 4096 trials each, the log of a standard deviation has an error of 1/sqrt(2 * 4096) =
// 1.1 %, more for heavy tails, and the slope over log 64 one of 0.01. If few bright samples carried the sky's light,
// the slope would differ, and the largest sample would be far from the mean.
TEST(EnvironmentSampling, ASunOfTenThousandGivesNoFireflies) {
  const Environment map = painted(64, 32, [](int x, int y) {
    return Rgb((x == 20 || x == 21) && (y == 7 || y == 8) ? 1e4f : y < 16 ? 1.0f : 0.0f);
  });
  LightScene scene;
  scene.frame.environment = &map;
  const Lights lights = scene.lights();
  const Vec3 up{0, 1, 0};
  const double mean = sampled_irradiance(lights, up, 1 << 18, 99);
  std::vector<double> x, y;
  double greatest = 0;
  for (int n = 4; n <= 256; n *= 2) {
    double square = 0;
    for (int trial = 0; trial < 4096; ++trial) {
      const double e = sampled_irradiance(lights, up, n, 1000 + std::uint64_t(trial)) / mean;
      square += (e - 1) * (e - 1);
      if (n == 4) greatest = std::max(greatest, e);
    }
    x.push_back(std::log2(n));
    y.push_back(std::log2(std::sqrt(square / 4096)));
  }
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
  const double count = double(x.size()), slope = (count * sxy - sx * sy) / (count * sxx - sx * sx);
  std::printf("error %.4f at 4 samples, %.4f at 256; slope %.3f; largest of 4096 means of 4: %.2f\n",
              std::exp2(y.front()), std::exp2(y.back()), slope, greatest);
  EXPECT_GT(slope, -0.6);
  EXPECT_LT(slope, -0.45);
  EXPECT_LT(greatest, 2);
}

// The irradiance of a uniform sky is pi L on any plane, and that of lamp and sky the sum of both, for any choice
// probabilities. The pdfs of lights that a ray meets agree with those of the samples.
TEST(EnvironmentAmongLights, SumsAndDensitiesAgree) {
  const Environment white = painted(8, 4, [](int, int) { return Rgb(0.5f); });
  LightScene scene;
  scene.add(square_facing_down({0, 0, 2}, 1), Rgb(3.0f));
  scene.add(PunctualLight::Kind::directional, Rgb(0.7f), {}, {0, 0, -1});
  scene.frame.environment = &white;
  const Lights lights = scene.lights();
  const Vec3 normal{0, 0, 1};
  const double expected = 0.5 * kPiD + 0.7 + 3 * polygon_irradiance({}, normal, square_facing_down({0, 0, 2}, 1));
  EXPECT_NEAR(sampled_irradiance(lights, normal, 1 << 18, 5), expected, 0.01 * expected);  // sigma of one: about 1
  for (int i = 0; i < 1000; ++i) {
    LightSample s;
    const PathRandom random(1, std::uint64_t(i));
    if (!lights.sample({}, normal, random.get2(0, Purpose::light_point), s) || s.only_sampled) continue;
    if (s.position_offset > 0) continue;  // the lamp
    EXPECT_NEAR(pdf_environment(lights, {}, normal, s.wi), s.pdf_solid_angle, 2e-3f * s.pdf_solid_angle);
  }
}

// The mean of emitted flux is total_flux = pi R^2 int L; photons start on the disc and cross the scene sphere.
TEST(EnvironmentEmission, MeanFluxAndDisc) {
  const Environment map = painted(16, 12, sky, 33);
  LightScene scene(2);
  scene.add(square_facing_down({0, 0, 1}, 0.1f), Rgb(1.0f));
  scene.frame.environment = &map;
  const Lights lights = scene.lights();
  const double radius = std::sqrt(12.0), disc = kPiD * radius * radius;
  const double expected = EnvironmentLight(map).integral().g * disc + kPiD * 0.04;
  EXPECT_NEAR(lights.total_flux().g, expected, 1e-4 * expected);
  ASSERT_EQ(lights.slots().back().kind, EmissionSlot::Kind::environment);
  EXPECT_NEAR(lights.slots().back().probability, 0.75, 1e-12);  // the lamp's least share is a quarter
  const PhotonHalton halton(1);
  constexpr int kCount = 1 << 16;
  double sum = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto u = halton.point(std::uint64_t(i));
    const PhotonEmission e = lights.emit(u);
    sum += double(e.flux.g) / kCount;
    if (lights.slots()[e.slot].kind != EmissionSlot::Kind::environment) continue;
    EXPECT_NEAR(dot(e.origin, e.travel), -radius, 1e-3);
    EXPECT_LT(length(e.origin + e.travel * float(radius)), radius * 1.001);
    EXPECT_EQ(e.normal, Vec3{});
  }
  // The sky's colours differ from the sun's by a factor of up to 3, but the sky has 2 % of the luminance.
  EXPECT_NEAR(sum, expected, 5e-3 * expected);
}

// Probabilities are fixed over a segment: a lamp that grows to four times its size from one frame to the next changes
// none of them, and the table uses the larger size.
TEST(EnvironmentEmission, IsFrozenOverASegment) {
  const Environment white = painted(1, 1, [](int, int) { return Rgb(1e-3f); });
  LightScene small, large;
  small.add(square_facing_down({0, 0, 1}, 1), Rgb(1.0f));
  large.add(square_facing_down({0, 0, 1}, 2), Rgb(1.0f));
  small.frame.environment = large.frame.environment = &white;
  const std::vector<SceneFrame> frames{small.frame, large.frame};
  const EmissionTable table = build_emission_table(frames);
  const double sky_flux = 4 * kPiD * 1e-3 * kPiD * 75, lamp_flux = kPiD * 16;
  EXPECT_NEAR(table.probability.back(), std::max(0.25, sky_flux / (sky_flux + lamp_flux)), 1e-4);
  for (const SceneFrame& frame : frames)
    EXPECT_EQ(Lights(frame, table).slots().back().probability, table.probability.back());
}

/// A pixel of 64 x 32 at the equator has .0096 sr of 12.57. At 356 means of the map it is a sun. A pixel that is 250
/// times as bright as the rest brings 16 % of the light and is 211 means: no sun. One 1000 times as bright brings 43 %
/// and is 568 means. Of 640 x 320, it brings .8 % and is 992 means: too little light.
TEST(EnvironmentLight, ASunIsBrightAndBringsLight) {
  const auto has_sun = [](int width, float times) {
    return EnvironmentLight(
               painted(width, width / 2, [&](int x, int y) { return Rgb(x == 5 && y == width / 4 ? times : 1.0f); }))
        .has_sun();
  };
  EXPECT_FALSE(has_sun(64, 1));
  EXPECT_FALSE(has_sun(64, 250));
  EXPECT_TRUE(has_sun(64, 1000));
  EXPECT_FALSE(has_sun(640, 1000));
  EXPECT_TRUE(has_sun(640, 10000));
  EXPECT_FALSE(EnvironmentLight(painted(4, 2, [](int, int) { return Rgb(0.0f); })).has_sun());
}

}  // namespace
}  // namespace tempolux
