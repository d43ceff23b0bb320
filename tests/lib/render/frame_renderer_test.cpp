// Whole frames: layers add up, the number of threads has no effect, halves are independent, data channels are correct.
#include "lib/render/frame_renderer.h"

#include <gtest/gtest.h>

#include <span>
#include <cmath>

#include "formats/error.h"
#include "lib/core/parallel.h"
#include "lib/render/data_channels.h"
#include "lib/render/known_light.h"
#include "lib/render/localised_light.h"
#include "tests/support/frames.h"
#include "tests/support/photons.h"

namespace tempolux {
namespace {

using test::Cornell;

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
      for (const char* layer : std::span(kLayerNames).first(std::size_t(Layer::volume)))  // without media none of them
        sum += (*image.rgb(layer)[std::size_t(ch)])[p];
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

double squared_difference(const LayerImage& a, const LayerImage& b) {
  double sum = 0;
  for (std::size_t p = 0; p < a.pixels.size(); ++p) {
    const Rgbd d = Rgbd(total(a.pixels[p])) - Rgbd(total(b.pixels[p]));
    sum += d.r * d.r + d.g * d.g + d.b * d.b;
  }
  return sum;
}

/// The difference between a frame and either half of a reference with the same seed and samples is as large as the
/// difference of the halves: variances add up. With equal random numbers it would be 0. The distributions have heavy
/// tails: such sums scatter by 10 % (below), so two of them agree within 30 %.
TEST(FrameRenderer, HalvesAreIndependentOfFramesOfTheSameSeed) {
  const Cornell c;
  FrameOptions options;
  options.samples = 4;
  const RenderedFrame plain = render_frame(c.render_scene(), c.view, options);
  options.samples = 8;
  options.halves = true;
  const RenderedFrame reference = render_frame(c.render_scene(), c.view, options);
  const double apart = squared_difference(reference.half[0], reference.half[1]);
  for (const LayerImage* half : {&reference.half[0], &reference.half[1]}) {
    EXPECT_NEAR(squared_difference(plain.mean, *half) / apart, 1, 0.3);
  }
}

/// The error of the mean that the halves report agrees with the true error, which is the difference of two independent
/// means over the square root of two.
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
  EXPECT_NEAR(one.noise.image.linear / rmse, 1, 0.3);
}

/// The number of a pixel's samples depends on the pixels around it and on the picture's mean, with and without a mask:
/// single pixels, a row and a block have the same bytes as in the whole frame. (If masked pixels alone decided, every
/// sixth would differ.)
TEST(FrameRenderer, MaskedPixelsAreThoseOfTheWholeFrame) {
  const Cornell c;
  FrameOptions options;
  options.samples = 4;
  options.pixel_error = 0.02;
  const RenderedFrame full = render_frame(c.render_scene(), c.view, options);
  ASSERT_GT(full.samples_per_pixel, 6);
  options.mask.assign(64 * 36, 0);
  for (std::size_t p = 0; p < options.mask.size(); ++p)
    options.mask[p] = p % 97 == 0 || p / 64 == 20 || (p / 64 < 8 && p % 64 > 50);
  const RenderedFrame part = render_frame(c.render_scene(), c.view, options);
  EXPECT_LT(part.rays.camera, full.rays.camera);
  for (std::size_t p = 0; p < options.mask.size(); ++p) {
    if (!options.mask[p]) continue;
    for (std::size_t l = 0; l < kLayerCount; ++l)
      ASSERT_EQ(part.mean.pixels[p].value[l], full.mean.pixels[p].value[l]) << p;
  }
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
  keep_base_pixels(options.mask, base, 0, image);
  for (std::size_t k = 0; k < image.channels.size(); ++k)
    for (std::size_t p = 0; p < options.mask.size(); ++p) {
      const float expected = options.mask[p] ? traced.channels[k].values[p] : base.channels[k].values[p];
      ASSERT_EQ(std::signbit(image.channels[k].values[p]), std::signbit(expected));
      ASSERT_EQ(image.channels[k].values[p], expected);
      if (options.mask[p] && k > 0) { ASSERT_EQ(image.channels[k].values[p], base.channels[k].values[p]); }
    }
  Image small{8, 8, {}, {}, {}, {}};
  EXPECT_THROW(keep_base_pixels(options.mask, small, 0, image), InputError);
  base.channels.pop_back();
  EXPECT_THROW(keep_base_pixels(options.mask, base, 0, image), InputError);
}

TEST(FrameRenderer, ABaseWithoutNoiseIsKnown) {
  Image base{2, 1, {}, {}, {}, {}}, image = base;
  base.add("direct.R").values = {3, 4};
  for (const char* name : {"albedo.R", "direct.R", "direct.noise.R"}) image.add(name).values = {1, 2};
  keep_base_pixels({0, 1}, base, 1, image);
  EXPECT_EQ(image.find("albedo.R")->values, (std::vector<float>{1, 2}));  // valid for every pixel
  EXPECT_EQ(image.find("direct.R")->values, (std::vector<float>{3, 2}));
  EXPECT_EQ(image.find("direct.noise.R")->values, (std::vector<float>{0, 2}));
}

/// One record lies where the frame's centre looks. No mover changes its light: as a plain and as a localised record it
/// gives frames the same noise.
TEST(FrameRenderer, NoiseOfLocalisedRecordsIsThatOfPlainOnes) {
  const Cornell c;
  const IrradianceRecord record = c.record_at({32, 18}, 0.2f, {0.5f, -1, 0.25f});
  RecordStore store(0);
  ASSERT_TRUE(store.add(record));
  const std::vector<RecordChange> changes{{record.irradiance, 0}};
  const LocalisedLight localised({&record, 1}, changes, {}, 0, {}, MovingObjects(c.frame));
  KnownLight plain, with_movers;
  plain.records = &store;
  with_movers.localised = &localised;
  FrameOptions options;
  options.samples = 2;
  const auto noise_of = [&](const KnownLight& known) {
    options.known = &known;
    return render_frame(c.render_scene(), c.view, options).mean.stored_noise;
  };
  const std::vector<StoredNoise> expected = noise_of(plain), found = noise_of(with_movers);
  ASSERT_EQ(found.size(), expected.size());
  bool any = false;
  for (std::size_t p = 0; p < found.size(); ++p) {
    any |= expected[p].indirect.g < 0;
    ASSERT_EQ(found[p].indirect, expected[p].indirect) << p;
  }
  EXPECT_TRUE(any);
}

/// Image means of the photon renderer's layers against those of the path tracer. Emission and direct light come from
/// the same samples (the continued ray is joined with light sampling in both). Indirect light has the bias of the
/// density estimate, which is darker at edges within its radius (3 cm in a 4 m room with 300 k photons: below 3 %).
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
  KnownLight known;
  known.photons = &light;
  options.known = &known;
  const RenderedFrame direct = render_frame(c.render_scene(), c.view, options);

  const auto mean = [](const RenderedFrame& frame, Layer layer) {
    double sum = 0;
    for (const Layers& pixel : frame.mean.pixels) sum += double(pixel[layer].g);
    return sum / double(frame.mean.pixels.size());
  };
  EXPECT_EQ(mean(direct, Layer::emission), mean(path, Layer::emission));  // the same camera rays
  EXPECT_EQ(mean(direct, Layer::direct), mean(path, Layer::direct));
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

/// The camera is fixed, and a box moves to the right and up by known steps: +u is right, +v is up.
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
  add_data_channels(base.render_scene(), base.view, {"P", "id", "motion"}, {&later, &base.view}, {&earlier, &base.view},
                    image);
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

/// A shift of a quarter of the picture's height to the right and half of it down: the picture's centre sees there.
TEST(CameraView, LensShiftMovesThePicture) {
  for (const Camera::Kind kind : {Camera::Kind::perspective, Camera::Kind::orthographic}) {
    PlacedCamera placed;
    placed.camera.kind = kind;
    placed.camera.yfov_rad = 2 * std::atan(0.4);
    placed.camera.ymag_m = 0.4;
    placed.camera.lens_shift = {0.25, -0.5};
    const CameraView view(placed, {}, 64, 36);
    const Vec3 seen{0.2f * 3, -0.4f * 3, -3}, level{0.2f, -0.4f, -3};
    const auto raster = view.project(view.orthographic() ? level : seen);
    EXPECT_NEAR((*raster)[0], 32, 1e-5);
    EXPECT_NEAR((*raster)[1], 18, 1e-5);
    const Ray ray = view.pinhole({10, 30});
    const auto back = view.project(ray.origin + ray.direction * 5);
    EXPECT_NEAR((*back)[0], 10, 1e-4);
    EXPECT_NEAR((*back)[1], 30, 1e-4);
    const auto m = view.world_to_ndc();
    const Vec3d p{0.3, 0.8, -2.5};
    double h[4];
    for (std::size_t k = 0; k < 4; ++k) h[k] = p.x * m[k] + p.y * m[4 + k] + p.z * m[8 + k] + m[12 + k];
    const auto at = view.project(Vec3(p));
    EXPECT_NEAR(h[0] / h[3] * 64, (*at)[0], 1e-4);
    EXPECT_NEAR(h[1] / h[3] * 36, (*at)[1], 1e-4);
  }
}

}  // namespace
}  // namespace tempolux
