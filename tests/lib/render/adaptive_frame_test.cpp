// Samples of pixels by what their neighbours saw: where they go, that they bring no bias, that no pixel is left standing out.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/frames.h"

namespace tempolux {
namespace {

using test::Cornell;
using test::from_above;
using test::NoLight;

/// Extra samples go where neighbours are uncertain; a pixel's own luck must not decide. Direct light of the pixels
/// that scatter most between 48 seeds, penumbrae and edges, two base samples each, against 1024 samples
/// everywhere: 4 sigma of the mean of their errors. (Deciding by a pixel's own samples comes out 0.8 % too
/// dark, six sigma.)
TEST(AdaptiveFrame, SamplesWhereTheyAreNeededBringNoBias) {
  const Cornell c;
  const NoLight none;
  FrameOptions options;
  options.diffuse_light = &none;
  options.samples = 1024;
  const RenderedFrame reference = render_frame(c.render_scene(), c.view, options);
  options.samples = 2;
  options.pixel_error = 0.02;
  constexpr int kSeeds = 48;
  const std::size_t pixels = reference.mean.pixels.size();
  std::vector<double> sum(pixels), sum2(pixels);
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = std::uint64_t(seed) + 1;
    const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
    for (std::size_t p = 0; p < pixels; ++p) {
      const double value = double(frame.mean.pixels[p][Layer::direct].g);
      sum[p] += value;
      sum2[p] += value * value;
    }
  }
  double error = 0, variance = 0, total_light = 0;
  int chosen = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    const double mean = sum[p] / kSeeds, var = std::max(0.0, sum2[p] / kSeeds - mean * mean) / (kSeeds - 1);
    const double expected = double(reference.mean.pixels[p][Layer::direct].g);
    if (!(std::sqrt(var * kSeeds) > 0.05 * expected) || !(expected > 0)) continue;
    ++chosen;
    error += mean - expected;
    variance += var;
    total_light += expected;
  }
  EXPECT_GT(chosen, 100);
  EXPECT_NEAR(error / total_light, 0, 4 * std::sqrt(variance) / total_light + 0.0005);
  EXPECT_LT(4 * std::sqrt(variance) / total_light, 0.006);
}
/// A thin sheet that lets half of the light through, a second of the same mesh behind it, which faces the same way; the first
/// gets no indirect light, the second does: what is seen through the first is asked for in every sample, not taken from
/// what the pixel's first samples met on the mesh. The specular layer's mean with extra samples against 256 everywhere:
/// within 5 %, four times the scatter of a run. (Reused, nothing of that light is left.)
TEST(AdaptiveFrame, ExtraSamplesReuseOnlyWhatTheCameraRayMeets) {
  Material sheet = test::matte(Rgb(0.5f));
  sheet.transmission = 0.5f;
  sheet.roughness = 0;
  test::HandMadeScene made;
  made.add({{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}, {-4, -4, -1}, {4, -4, -1}, {4, 4, -1}, {-4, 4, -1}},
           {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}, sheet);
  made.add_point_light({0, 0, 3}, Rgb(1.0f));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  struct SecondAlone : DiffuseLight {
    Irradiance at(const SurfacePoint& surface, Vec3, Vec3, bool, const Rgb*) const override {
      return {Rgb(0.0f), Rgb(surface.position.z < -0.5f ? 1.0f : 0.0f)};
    }
  } light;
  PlacedCamera camera;
  camera.scene_from_camera.translation = {0, 0, 4};
  const CameraView view(camera, {}, 32, 18);
  const auto specular_of = [&](int samples, double pixel_error) {
    FrameOptions options;
    options.diffuse_light = &light;
    options.samples = samples;
    options.pixel_error = pixel_error;
    double sum = 0;
    for (const Layers& pixel : render_frame({tracer, lights}, view, options).mean.pixels) sum += double(pixel[Layer::specular].g);
    return sum;
  };
  EXPECT_NEAR(specular_of(2, 0.005) / specular_of(256, 0), 1, 0.05);
}
/// A bright sheet and a black one that meet in the middle of a column of pixels: of four samples, stratified, two are on either.
/// Asked for more than it may have, a pixel that has an edge or is beside one takes all: that column and one on either side.
/// Where they meet between two columns no pixel's samples differ, but those of its neighbours do: both columns take all.
TEST(AdaptiveFrame, EdgesArePaidForByThePixelsBesideThemAlone) {
  for (const auto& [column, taken] : {std::pair{20.5f, 3.0}, std::pair{20.0f, 2.0}}) {
    const float edge = column / 32;
    test::HandMadeScene made;
    made.add_quad({-2, -2, 0}, {edge, -2, 0}, {edge, 2, 0}, {-2, 2, 0}, test::matte(Rgb(0.0f), Rgb(1.0f)));
    made.add_quad({edge, -2, 0}, {2, -2, 0}, {2, 2, 0}, {edge, 2, 0}, test::matte(Rgb(0.0f)));
    const SceneFrame& frame = made.frame();
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    const CameraView view = from_above();
    FrameOptions options;
    options.samples = 4;
    options.pixel_error = 1e-6;
    options.adaptive_limit = 16;
    EXPECT_DOUBLE_EQ(render_frame({tracer, lights}, view, options).samples_per_pixel, 4 + 12 * taken / 64) << column;
  }
}

/// Where all of a large light is seen its noise is taken out. Four samples of the lamp by solid angle leave a pixel of the box
/// a scatter of 1 % and more, by the cosines that differ over it: three pixels of four are off by half a per cent. Without,
/// only those are off by as much that hold edges or lie where shadows begin: a third of them.
TEST(AdaptiveFrame, LightThatNothingIsInTheWayOfHasNoNoise) {
  const Cornell c;
  const NoLight none;
  FrameOptions options;
  options.diffuse_light = &none;
  options.samples = 4;
  options.pixel_error = 1;   // no further samples
  const RenderedFrame one = render_frame(c.render_scene(), c.view, options);
  options.samples = 256;
  const RenderedFrame exact = render_frame(c.render_scene(), c.view, options);
  int still = 0, lit = 0;
  for (std::size_t p = 0; p < one.mean.pixels.size(); ++p) {
    const float is = one.mean.pixels[p][Layer::direct].g, should = exact.mean.pixels[p][Layer::direct].g;
    EXPECT_GE(is, 0);
    if (!(should > 0.05f)) continue;
    ++lit;
    if (std::abs(is / should - 1) < 0.005f) ++still;
  }
  EXPECT_GT(still, lit / 2) << lit;
}

/// The border of the shadow that a sheet cut across throws of a square lamp: of the lamp's area (1 - s)^2 / 2 are covered where
/// x + y = (0.6 s - 0.5) / 0.4, none from s = 1 on; looked at is s from 0.82 to 0.99, p < 1.6 %. Of four samples one misses it in 4 p
/// of the pixels, which makes a dot 25 % dark; where neighbours do not call for more, that stays: of .7 % of all. With 20 samples
/// where that happened three must miss, about (20 p)^3 / 6 of the pixels, .02 % at p = .5 %. The mean over that part and all seeds is
/// right within 4 sigma, for what dots are given is taken back beside them: else it would be .26 % too bright.
TEST(AdaptiveFrame, BordersOfShadowsHaveNoDots) {
  test::HandMadeScene made;
  made.add_quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}, test::matte(Rgb(0.5f)));
  made.add_quad({-0.5f, -0.5f, 2}, {-0.5f, 0.5f, 2}, {0.5f, 0.5f, 2}, {0.5f, -0.5f, 2}, test::matte(Rgb(0.0f), Rgb(1.0f)));
  made.add_quad({2.5f, -3, 1.2f}, {-3, 2.5f, 1.2f}, {-6, -0.5f, 1.2f}, {-0.5f, -6, 1.2f}, test::matte(Rgb(0.0f)));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  ASSERT_TRUE(lights.has_large());
  const CameraView view = from_above();
  const NoLight none;
  FrameOptions options;
  options.diffuse_light = &none;
  options.samples = 4096;
  const RenderedFrame exact = render_frame({tracer, lights}, view, options);
  options.samples = 4;
  options.pixel_error = 0.0125;
  constexpr int kSeeds = 32;
  int looked_at = 0, dots = 0;
  double light = 0;
  std::array<double, kSeeds> means{};
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = std::uint64_t(seed) + 1;
    const RenderedFrame rendered = render_frame({tracer, lights}, view, options);
    light = 0;
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 64; ++x) {
        const double u = (x + 0.5) / 32 - 1 + 0.5625 - (y + 0.5) / 32, s = (0.4 * u + 0.5) / 0.6;
        if (s < 0.82 || s > 0.99) continue;
        const auto at = std::size_t(y * 64 + x);
        const double is = double(rendered.mean.pixels[at][Layer::direct].g), should = double(exact.mean.pixels[at][Layer::direct].g);
        ++looked_at;
        dots += std::abs(is / should - 1) > 0.15;
        means[std::size_t(seed)] += is;
        light += should;
      }
  }
  EXPECT_GT(looked_at, 100 * kSeeds);
  EXPECT_LT(dots, 0.002 * looked_at) << looked_at;
  double sum = 0, square = 0;
  for (double& mean : means) {
    mean = mean / light - 1;
    sum += mean;
    square += mean * mean;
  }
  const double sigma = std::sqrt((square - sum * sum / kSeeds) / (kSeeds - 1) / kSeeds);
  EXPECT_NEAR(sum / kSeeds, 0, 4 * sigma + 0.0002);
  EXPECT_LT(sigma, 4e-4);
}

/// Lamps of a 25th of a pixel in a mirror, which else shows .2: of a lamp's pixels 16 % meet it with one of their four samples and
/// then show 6.25; the neighbours met nothing and call for no more. By all its samples sigma is 12.5 and such a pixel takes 12 (12.5 /
/// (12 x .0125 x .23))^(3/4), about 1000: 1.2 +- .15. What that takes from it is shared out: the mean over the picture is right
/// within 4 sigma of 32 seeds; without that, 84 % of the lamps' light were missing, 9.6 % of all.
TEST(AdaptiveFrame, LampsSmallerThanPixelsLeaveNoSpotsInMirrors) {
  Material mirror = test::matte(Rgb(1.0f));
  mirror.metallic = 1;
  mirror.roughness = 0;
  test::HandMadeScene made;
  made.add_quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, mirror);
  made.add_quad({-9, -9, 3}, {-9, 9, 3}, {9, 9, 3}, {9, -9, 3}, test::matte(Rgb(0.0f), Rgb(0.2f)));
  constexpr int kApart = 6, kAcross = 64 / kApart, kDown = 36 / kApart;
  constexpr float kPixel = 1 / 32.0f, kSide = kPixel / 5;
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAcross; ++i) {
      const float x = (kApart * float(i) + 2.1f) * kPixel - 1, y = 0.5625f - (kApart * float(j) + 2.1f) * kPixel;
      made.add_quad({x, y - kSide, 2}, {x, y, 2}, {x + kSide, y, 2}, {x + kSide, y - kSide, 2},
                    test::matte(Rgb(0.0f), Rgb(25.0f)));
    }
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  const CameraView view = from_above();
  const NoLight none;
  FrameOptions options;
  options.diffuse_light = &none;
  options.samples = 4;
  options.pixel_error = 0.0125;
  constexpr int kSeeds = 32;
  int spots = 0, met = 0;
  double sum = 0, square = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = std::uint64_t(seed) + 1;
    const RenderedFrame rendered = render_frame({tracer, lights}, view, options);
    double mean = 0;
    for (const Layers& pixel : rendered.mean.pixels) {
      const double value = double(pixel[Layer::specular].g);
      mean += value / (64 * 36);
      met += value > 0.6;
      spots += value > 2;
    }
    sum += mean;
    square += mean * mean;
  }
  EXPECT_GT(met, 0.1 * kSeeds * kAcross * kDown);
  EXPECT_EQ(spots, 0) << met;
  const double lamps = kAcross * kDown / (64 * 36 * 25.0), exact = 0.2 + lamps * (25 - 0.2);
  const double sigma = std::sqrt((square - sum * sum / kSeeds) / (kSeeds - 1) / kSeeds);
  EXPECT_NEAR(sum / kSeeds, exact, 4 * sigma);
  EXPECT_LT(sigma, 0.01 * exact);
}

}  // namespace
}  // namespace tempolux
