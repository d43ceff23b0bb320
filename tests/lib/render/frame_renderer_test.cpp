// Whole frames: layers add up, threads change nothing, halves are independent, data channels are where they say.
#include "lib/render/frame_renderer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/render/photon_light.h"
#include "lib/scene/gltf_load.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

/// pipelines/scenes/S2_cornell_moving.glb: matte boxes, one of them moving.
struct Cornell {
  Scene scene = load_gltf("../pipelines/scenes/S2_cornell_moving.glb");
  TimeOptions time;
  Segment segment;
  SceneFrame frame;
  Tracer tracer;
  Lights lights;
  CameraView view;

  explicit Cornell(int number = 10, int width = 64, int height = 36)
      : segment(segment_of(scene, number, time)),
        frame(scene_at_frame(scene, segment, number, time)),
        tracer(frame),
        lights(frame, build_emission_table(scene, segment, time)),
        view(frame.camera(scene.camera_node("auto")), frame.origin, width, height) {}
  RenderScene render_scene() const { return {tracer, lights}; }
};

/// 64 x 36 pixels of 1/32 m, seen from z = 1, the middle at the origin.
CameraView from_above() {
  PlacedCamera camera;
  camera.camera.kind = Camera::Kind::orthographic;
  camera.camera.ymag_m = 0.5625f;
  camera.scene_from_camera.translation = {0, 0, 1};
  return CameraView(camera, {}, 64, 36);
}

Rgb total(const Layers& layers) {
  Rgb sum = layers.value[0];
  for (std::size_t l = 1; l < kLayerCount; ++l) sum += layers.value[l];
  return sum;
}

TEST(FrameRenderer, SumOfLayersIsTheImageExactly) {
  const Cornell c;
  FrameOptions options;
  options.samples = 4;
  const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
  Image image{64, 36, {}, {}, {}, {}};
  add_colour_channels(frame.mean, {"RGBA", "layers"}, image);
  const auto rgb = image.rgb("");
  for (std::size_t p = 0; p < image.pixel_count(); ++p)
    for (int ch = 0; ch < 3; ++ch) {
      float sum = 0;
      for (const char* layer : kLayerNames) sum += (*image.rgb(layer)[std::size_t(ch)])[p];
      ASSERT_EQ(sum, (*rgb[std::size_t(ch)])[p]);
    }
}

TEST(FrameRenderer, PixelsAreEqualForAnyNumberOfThreads) {
  const Cornell c;
  FrameOptions options;
  options.samples = 2;
  std::vector<Layers> first;
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    const auto pixels = render_frame(c.render_scene(), c.view, options).mean.pixels;
    if (first.empty()) first = pixels;
    for (std::size_t p = 0; p < pixels.size(); ++p)
      for (std::size_t l = 0; l < kLayerCount; ++l) ASSERT_EQ(pixels[p].value[l], first[p].value[l]) << threads;
  }
}

/// The estimate that the halves give of their mean's error agrees with the true one: the difference of two
/// independent means is its square root of two times.
TEST(FrameRenderer, HalvesAreIndependentAndTellTheError) {
  const Cornell c;
  FrameOptions options;
  options.samples = 8;
  options.halves = true;
  const RenderedFrame one = render_frame(c.render_scene(), c.view, options);
  options.seed = 1;
  const RenderedFrame two = render_frame(c.render_scene(), c.view, options);
  double difference2 = 0;
  for (std::size_t p = 0; p < one.mean.pixels.size(); ++p) {
    const Rgbd d = Rgbd(total(one.mean.pixels[p])) - Rgbd(total(two.mean.pixels[p]));
    difference2 += d.r * d.r + d.g * d.g + d.b * d.b;
    EXPECT_EQ(one.mean.pixels[p].value[2], (one.half[0].pixels[p].value[2] + one.half[1].pixels[p].value[2]) * 0.5f);
  }
  const double rmse = std::sqrt(difference2 / 2 / double(3 * one.mean.pixels.size()));
  // 2304 pixels with heavy tails: the ratio of two such estimates scatters by 10 % or so.
  EXPECT_NEAR(one.own_rmse / rmse, 1, 0.3);
}

/// Direct light alone.
struct NoLight : DiffuseLight {
  Irradiance at(const SurfacePoint&, Vec3, Vec3, bool, const Rgb*) const override { return {}; }
};

/// Extra samples go where neighbours are uncertain; a pixel's own luck must not decide. Direct light of the pixels
/// that scatter most between 48 seeds, penumbrae and edges, two base samples each, against 1024 samples
/// everywhere: 4 sigma of the mean of their errors. (Deciding by a pixel's own samples comes out 0.8 % too
/// dark, six sigma.)
TEST(FrameRenderer, SamplesWhereTheyAreNeededBringNoBias) {
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
TEST(FrameRenderer, ExtraSamplesReuseOnlyWhatTheCameraRayMeets) {
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

/// Caustic irradiance x [m] on a floor of two meshes, 64 x 36 pixels of 1/32 m. Where photons are few (sparse_radius 1 m) an
/// answer may be taken from an eighth of that, four pixels, away: no pixel is farther off than that and its own half, most are
/// not asked for. Where they are not each pixel is asked for and right to its half. Neither takes an answer from beyond the
/// seam at x = 0, where the other mesh gives -x.
TEST(FrameRenderer, SparseCausticLightIsTakenFromNearbyOnly) {
  test::HandMadeScene made;
  made.add_quad({-2, -2, 0}, {0, -2, 0}, {0, 2, 0}, {-2, 2, 0}, test::matte(Rgb(1.0f)));
  made.add_quad({0, -2, 0}, {2, -2, 0}, {2, 2, 0}, {0, 2, 0}, test::matte(Rgb(1.0f)));
  const SceneFrame& frame = made.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  struct Slope : DiffuseLight {
    float sparse_radius = 0;
    mutable std::atomic<int> asked = 0;
    Irradiance at(const SurfacePoint& surface, Vec3, Vec3, bool, const Rgb* caustic) const override {
      if (caustic) return {*caustic, Rgb(0.0f)};
      ++asked;
      return {Rgb(std::abs(surface.position.x)), Rgb(0.0f), sparse_radius};
    }
  } light;
  const CameraView view = from_above();
  FrameOptions options;
  options.diffuse_light = &light;
  options.samples = 2;
  options.pixel_error = 1;
  for (const float radius : {0.0f, 1.0f}) {
    light.sparse_radius = radius;
    light.asked = 0;
    const RenderedFrame rendered = render_frame({tracer, lights}, view, options);
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 64; ++x) {
        const float expected = std::abs((float(x) + 0.5f) / 32 - 1);
        EXPECT_NEAR(rendered.mean.pixels[std::size_t(y * 64 + x)][Layer::caustic].g * kPi, expected, radius / 8 + 0.5f / 32 + 1e-5f);
      }
    if (radius > 0) EXPECT_LT(light.asked, 64 * 36 / 4);
    else EXPECT_EQ(light.asked, 64 * 36);
  }
}

/// A bright sheet and a black one that meet in the middle of a column of pixels: of four samples, stratified, two are on either.
/// Asked for more than it may have, a pixel that has an edge or is beside one takes all: that column and one on either side.
/// Where they meet between two columns no pixel's samples differ, but those of its neighbours do: both columns take all.
TEST(FrameRenderer, EdgesArePaidForByThePixelsBesideThemAlone) {
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
TEST(FrameRenderer, LightThatNothingIsInTheWayOfHasNoNoise) {
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
TEST(FrameRenderer, BordersOfShadowsHaveNoDots) {
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

TEST(FrameRenderer, PixelsOutsideTheMaskAreTheBasesToTheBit) {
  const Cornell c;
  FrameOptions options;
  options.samples = 2;
  const RenderedFrame full = render_frame(c.render_scene(), c.view, options);
  Image base{64, 36, {}, {}, {}, {}};
  add_colour_channels(full.mean, {"RGBA"}, base);
  for (float& v : base.channels[0].values) v = -0.0f;
  options.mask.assign(64 * 36, 0);
  for (std::size_t p = 100; p < 400; ++p) options.mask[p] = 1;
  const RenderedFrame part = render_frame(c.render_scene(), c.view, options);
  EXPECT_EQ(part.rays.camera, 600u);
  Image image{64, 36, {}, {}, {}, {}};
  add_colour_channels(part.mean, {"RGBA"}, image);
  const Image traced = image;
  keep_base_pixels(options.mask, base, image);
  for (std::size_t k = 0; k < image.channels.size(); ++k)
    for (std::size_t p = 0; p < options.mask.size(); ++p) {
      const float expected = options.mask[p] ? traced.channels[k].values[p] : base.channels[k].values[p];
      ASSERT_EQ(std::signbit(image.channels[k].values[p]), std::signbit(expected));
      ASSERT_EQ(image.channels[k].values[p], expected);
      if (options.mask[p] && k > 0) { ASSERT_EQ(image.channels[k].values[p], base.channels[k].values[p]); }
    }
  Image small{8, 8, {}, {}, {}, {}};
  EXPECT_THROW(keep_base_pixels(options.mask, small, image), InputError);
  base.channels.pop_back();
  EXPECT_THROW(keep_base_pixels(options.mask, base, image), InputError);
}

TEST(FrameRenderer, TargetErrorIsReached) {
  const Cornell c;
  FrameOptions options;
  options.samples = 2;
  options.target_error = 0.08;
  const RenderedFrame frame = render_frame(c.render_scene(), c.view, options);
  EXPECT_LE(frame.own_rmse, 0.08 * frame.mean_radiance);
  EXPECT_GT(frame.mean.samples, 2);
  // Passes continue the same sequence: the same samples in one go give the same means up to rounding.
  options.target_error = 0;
  options.halves = true;
  options.samples = frame.mean.samples;
  const RenderedFrame again = render_frame(c.render_scene(), c.view, options);
  EXPECT_NEAR(again.mean_radiance, frame.mean_radiance, 1e-6 * frame.mean_radiance);
}

/// Layers of the photon renderer against those of the path tracer, as image means: emission and direct are the
/// same estimator without its second half; indirect carries the density estimate's bias, darker at edges within
/// the estimate's radius (3 cm of a 4 m room with 300 k photons: below 3 %).
TEST(FrameRenderer, PhotonLayersAgreeWithPathLayers) {
  const Cornell c;
  FrameOptions options;
  options.samples = 64;
  const RenderedFrame path = render_frame(c.render_scene(), c.view, options);
  PhotonOptions photon_options;
  photon_options.photon_count = 300000;
  const PhotonTracer tracer(c.tracer, c.lights, photon_options);
  const std::vector<formats::Photon> photons = test::photons_of(tracer);
  const PhotonLight light(c.tracer, photons, {}, {});
  options.diffuse_light = &light;
  const RenderedFrame direct = render_frame(c.render_scene(), c.view, options);

  const auto mean = [](const RenderedFrame& frame, Layer layer) {
    double sum = 0;
    for (const Layers& pixel : frame.mean.pixels) sum += double(pixel[layer].g);
    return sum / double(frame.mean.pixels.size());
  };
  EXPECT_EQ(mean(direct, Layer::emission), mean(path, Layer::emission));  // the same camera rays
  EXPECT_NEAR(mean(direct, Layer::direct) / mean(path, Layer::direct), 1, 0.01);
  EXPECT_NEAR(mean(direct, Layer::indirect) / mean(path, Layer::indirect), 1, 0.03);
  EXPECT_EQ(mean(path, Layer::caustic), 0);
  EXPECT_EQ(mean(direct, Layer::caustic), 0);
  EXPECT_EQ(mean(path, Layer::specular), 0);
}

TEST(DataChannels, DepthPositionAndMotionAgreeWithTheCamera) {
  const Cornell now(10), later(11), earlier(9);
  Image image{64, 36, {}, {}, {}, {}};
  add_data_channels(now.render_scene(), now.view, {"Z", "N", "P", "id", "albedo", "motion"},
                    {&later.frame, &later.view}, {&earlier.frame, &earlier.view}, image);
  const auto value = [&](const char* name, std::size_t p) { return image.find(name)->values[p]; };
  int moving = 0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    const Vec3 position{value("P.X", p), value("P.Y", p), value("P.Z", p)};
    EXPECT_NEAR(value("Z", p), now.view.depth(position), 1e-4);
    const auto raster = now.view.project(position);
    ASSERT_TRUE(raster);
    EXPECT_NEAR((*raster)[0], double(p % 64) + 0.5, 1e-3);
    EXPECT_NEAR((*raster)[1], double(p / 64) + 0.5, 1e-3);
    EXPECT_NEAR(length(Vec3{value("N.X", p), value("N.Y", p), value("N.Z", p)}), 1, 1e-5);
    const std::string& name = now.scene.object_names[image.find("id.object")->ids[p]];
    const float u = value("forward.u", p), v = value("forward.v", p);
    if (name == "MovingBox") {
      ++moving;
      EXPECT_GT(std::abs(u) + std::abs(v) + std::abs(value("backward.u", p)), 0.01f);
    } else {
      EXPECT_NEAR(u, 0, 1e-4);
      EXPECT_NEAR(v, 0, 1e-4);
    }
  }
  EXPECT_GT(moving, 20);
}

/// The camera fixed, a box that slides to the right and up by known steps: +u is right, +v is up.
TEST(DataChannels, MotionCountsPixelsRightAndUp) {
  const Cornell base(0);
  const auto shifted = [&](Vec3 step) {
    SceneFrame frame = base.frame;
    for (std::size_t s = frame.static_count; s < frame.surfaces.size(); ++s) {
      std::vector<Vec3> p(frame.surfaces[s].positions.begin(), frame.surfaces[s].positions.end());
      for (Vec3& x : p) x += step;
      frame.surfaces[s].positions = p;
    }
    return frame;
  };
  ASSERT_LT(base.frame.static_count, base.frame.surfaces.size());
  const SceneFrame later = shifted({0.1f, 0.05f, 0}), earlier = shifted({-0.1f, -0.05f, 0});
  Image image{64, 36, {}, {}, {}, {}};
  add_data_channels(base.render_scene(), base.view, {"P", "id", "motion"}, {&later, &base.view}, {&earlier, &base.view}, image);
  int seen = 0;
  for (std::size_t p = 0; p < image.pixel_count(); ++p) {
    if (base.scene.object_names[image.find("id.object")->ids[p]] != "MovingBox") continue;
    ++seen;
    // Camera looks along -Z with a slight tilt: a step of (0.1, 0.05) at distance Z is about
    // 0.1 / (Z tan(yfov/2)) half heights of 18 pixels.
    EXPECT_GT(image.find("forward.u")->values[p], 0.5f);
    EXPECT_GT(image.find("forward.v")->values[p], 0.2f);
    EXPECT_LT(image.find("backward.u")->values[p], -0.5f);
    EXPECT_LT(image.find("backward.v")->values[p], -0.2f);
  }
  EXPECT_GT(seen, 10);
}

TEST(CameraView, NdcAttributeAgreesWithProjection) {
  const Cornell c;
  const auto m = c.view.world_to_ndc();
  const Vec3d p{0.3, 0.8, -0.5};
  double h[4];
  for (int k = 0; k < 4; ++k) h[k] = p.x * m[k] + p.y * m[4 + k] + p.z * m[8 + k] + m[12 + k];
  const auto raster = c.view.project(Vec3(p));
  EXPECT_NEAR(h[0] / h[3] * 64, (*raster)[0], 1e-4);
  EXPECT_NEAR(h[1] / h[3] * 36, (*raster)[1], 1e-4);
  EXPECT_NEAR(h[3], c.view.depth(Vec3(p)), 1e-6);
}

}  // namespace
}  // namespace tempolux
