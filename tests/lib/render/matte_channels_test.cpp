// Mattes by object and material against shares that are known on paper.
#include "lib/render/matte_channels.h"

#include <bit>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/image/cryptomatte.h"
#include "lib/render/shutter.h"
#include "lib/scene/camera_extras.h"
#include "tests/lib/scene/gltf_maker.h"
#include "tests/support/sliding_edge.h"

namespace tempolux {
namespace {

using test::expected_column;

constexpr int kWidth = 40, kHeight = 20;

/// Squares of 1 m before an orthographic camera at (1, .5, 3), 40 x 20 pixels of 1/20 m.
struct Stage {
  GltfMaker maker;
  int camera = -1;
  double shutter_frames = 0, lens_radius_m = 0;
  FrameOptions options;
  RenderedFrame rendered;

  Stage() { maker.add_material({{"name", "Unused"}}); }  // so that a material has another number than its object

  int add_square(const char* name, Json node, Json material = Json::object()) {
    material["name"] = std::string(name) + " paint";
    material["emissiveFactor"] = {1, 1, 1};
    node["name"] = name;
    node["mesh"] = maker.add_square(maker.add_material(material));
    return maker.add_node(node);
  }
  /// The frame 1 with its mattes.
  Image frame() {
    camera = maker.add_camera({{"translation", {1, 0.5, 3}}});
    maker.json["cameras"][0] = {{"type", "orthographic"},
                                {"orthographic", {{"xmag", 1}, {"ymag", 0.5}, {"znear", 0.01}, {"zfar", 9}}}};
    Scene scene = maker.load();
    CameraExtras& extras = scene.nodes[std::size_t(camera)].camera_extras;
    extras.set(&Camera::shutter_frames, shutter_frames);
    extras.set(&Camera::lens_radius_m, lens_radius_m);
    extras.set(&Camera::focus_m, 2);
    const Segment segment = segment_of(scene, 1, {});
    const SceneFrame frame = SegmentScene(scene, segment, {}).at(1);
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table(scene, segment, {}));
    const RenderScene lit{tracer, lights};
    const CameraView view(frame, camera, kWidth, kHeight);
    const auto shutter = Shutter::of({scene, {}, camera, lit, view});
    options.shutter = shutter.get();
    options.camera_samples = true;
    rendered = render_frame(lit, view, options);
    Image image{kWidth, kHeight, {}, {}, {}, {}};
    add_matte_channels(lit, view, options, rendered, MatteNames(scene), {"cryptomatte"}, image);
    return image;
  }
};

std::size_t at(int x, int y) { return std::size_t(kWidth * y + x); }

/// The share of a name in a pixel, as a compositor finds it: by its float in any rank.
double share(const Image& image, const std::string& layer, const std::string& name, std::size_t p) {
  double sum = 0;
  for (const char* number : {"00", "01", "02"})
    for (const auto& [hash, coverage] : {std::pair{".R", ".G"}, {".B", ".A"}})
      if (std::bit_cast<std::uint32_t>(image.find(layer + number + hash)->values[p]) == matte_bits(name))
        sum += double(image.find(layer + number + coverage)->values[p]);
  return sum;
}

double sum_of_ranks(const Image& image, const std::string& layer, std::size_t p) {
  double sum = 0;
  for (const char* number : {"00", "01", "02"})
    for (const char* coverage : {".G", ".A"}) sum += double(image.find(layer + number + coverage)->values[p]);
  return sum;
}

/// A square whose left edge lies at .7 of pixel 8 before one whose edge lies at .5 of it. 4096 points of a Sobol
/// sequence have one point in each 4096th of the pixel's width, so a share errs by at most 1 / 4096, and as much again
/// for the rounding of the edge's place to float32. Meant to catch: counts over all samples that hit something, the
/// hidden square counted too, the material of another surface.
TEST(MatteChannels, AnEdgeCoversItsShareOfThePixel) {
  Stage stage;
  stage.options.samples = 4096;
  stage.options.mask.assign(kWidth * kHeight, 0);
  std::fill_n(stage.options.mask.begin() + 40 * 5, kWidth, 1);
  stage.add_square("Front", {{"translation", {0.435, 0, 0.5}}});
  stage.add_square("Back", {{"translation", {0.425, 0, 0}}});
  const Image image = stage.frame();
  const double off = 2.0 / 4096;
  for (const auto& [layer, paint] : {std::pair{kObjectMattes, ""}, {kMaterialMattes, " paint"}}) {
    const auto of = [&](const char* name, int x) { return share(image, layer, std::string(name) + paint, at(x, 5)); };
    EXPECT_NEAR(of("Front", 8), 0.3, off);
    EXPECT_NEAR(of("Back", 8), 0.2, off);
    EXPECT_NEAR(of("Front", 28), 0.7, off);  // right edges at 1.435 and 1.425
    EXPECT_EQ(of("Back", 28), 0);
    EXPECT_EQ(of("Front", 15), 1);
    EXPECT_EQ(sum_of_ranks(image, layer, at(3, 5)), 0);
  }
  EXPECT_EQ(image.text.at("cryptomatte/3ae39a5/manifest").substr(0, 8), R"({"Back":)");
}

/// A square that slides by 8 pixels a frame, with the shutter open for half of it: its matte is a ramp of 4 pixels, and
/// the square behind has the rest. Mean over 12 rows of 4096 samples; as in shutter_test, .003 is above the standard
/// error of independent samples, .0023. Meant to catch: mattes of the frame's time alone, moments drawn with other
/// random numbers than colour (the sum would still be right; SharesAddUpToAlpha sees it).
TEST(MatteChannels, ASlidingEdgeIsARamp) {
  Stage stage;
  stage.options.samples = 4096;
  stage.shutter_frames = 0.5;
  stage.options.mask.assign(kWidth * kHeight, 0);
  std::fill(stage.options.mask.begin() + 40 * 4, stage.options.mask.begin() + 40 * 16, 1);
  const int mover = stage.add_square("Mover", Json::object());
  stage.add_square("Wall", {{"translation", {0, 0, -1}}, {"scale", {2, 1, 1}}});
  stage.maker.animate(mover, "translation", {0, 1 / 12.0f}, {0, 0, 0, 0.8f, 0, 0});
  const Image image = stage.frame();
  for (int x = 2; x < 38; ++x) {
    double mean = 0, wall = 0;
    for (int y = 4; y < 16; ++y) {
      mean += share(image, kObjectMattes, "Mover", at(x, y)) / 12;
      wall += share(image, kObjectMattes, "Wall", at(x, y)) / 12;
    }
    EXPECT_NEAR(mean, expected_column(8, 28, 4, x), 0.003) << x;
    EXPECT_NEAR(wall, 1 - mean, 1e-6) << x;
  }
}

/// Blurred by motion and lens, with adaptive samples or with halves: all shares of a pixel add up to its alpha, which
/// the samples of colour gave, to rounding. Alpha is a mean in float32 that is joined pass by pass, 2^-23 each. Meant
/// to catch: another seed, another number of samples, other moments.
TEST(MatteChannels, SharesAddUpToAlpha) {
  for (const bool halves : {false, true}) {
    Stage stage;
    stage.options.seed = 7;
    stage.options.samples = halves ? 8 : 4;
    stage.options.halves = halves;
    stage.options.pixel_error = halves ? 0 : 0.02;
    stage.shutter_frames = 1;
    stage.lens_radius_m = 0.1;
    const int mover = stage.add_square("Mover", Json::object());
    stage.add_square("Wall", {{"translation", {0.9, 0.3, -1}}, {"rotation", {0, 0, 0.2, std::sqrt(1 - 0.04)}}});
    stage.maker.animate(mover, "translation", {0, 1 / 12.0f}, {0, 0, 0, 0.8f, 0, 0});
    const Image image = stage.frame();
    int soft = 0;
    for (std::size_t p = 0; p < image.pixel_count(); ++p) {
      const double alpha = double(stage.rendered.mean.pixels[p].coverage);
      soft += alpha > 0 && alpha < 1;
      EXPECT_NEAR(sum_of_ranks(image, kObjectMattes, p), alpha, 1e-6) << p;
      EXPECT_NEAR(sum_of_ranks(image, kMaterialMattes, p), alpha, 1e-6) << p;
    }
    EXPECT_GT(soft, 100);
  }
}

/// A sheet of alpha .25 before a wall: its share is .25, and the wall has the rest. 500 pixels of 64 samples whose
/// chances are independent: standard error .0024; four of them.
TEST(MatteChannels, ASheetOfAlphaHasItsShare) {
  Stage stage;
  stage.options.samples = 64;
  stage.add_square("Sheet", {{"translation", {0, 0, 0.5}}, {"scale", {2, 1, 1}}},
                   {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.25}}}}});
  stage.add_square("Wall", {{"scale", {2, 1, 1}}});
  const Image image = stage.frame();
  double sheet = 0;
  for (std::size_t p = 100; p < 600; ++p) {
    sheet += share(image, kObjectMattes, "Sheet", p) / 500;
    EXPECT_NEAR(sum_of_ranks(image, kObjectMattes, p), 1, 1e-6);
  }
  EXPECT_NEAR(sheet, 0.25, 0.0096);
}

/// Pixels that are not rendered have mattes, too, of 16 samples; the bytes do not depend on the number of threads.
TEST(MatteChannels, KeptPixelsHaveMattesAndThreadsDoNotMatter) {
  const auto image_of = [](int threads) {
    const ThreadLimit limit(threads);
    Stage stage;
    stage.options.samples = 8;
    stage.options.mask.assign(kWidth * kHeight, 0);
    stage.options.mask[at(3, 3)] = 1;
    stage.add_square("Front", {{"translation", {0.4375, 0, 0.5}}});
    return stage.frame();
  };
  const Image one = image_of(1), three = image_of(3);
  EXPECT_NEAR(share(one, kObjectMattes, "Front", at(8, 10)), 0.25, 1.0 / 16);
  EXPECT_EQ(share(one, kObjectMattes, "Front", at(20, 10)), 1);
  EXPECT_EQ(digest_of(one), digest_of(three));
  EXPECT_EQ(one.text, three.text);
}

/// A frame on a base of another moment keeps its own mattes where it keeps the base's colour.
TEST(MatteChannels, AreNotTakenFromABase) {
  Image image{1, 1, {}, {}, {}, {}}, base = image;
  for (const char* name : {"CryptoObject00.G", "Z"}) {
    image.add(name).values = {1};
    base.add(name).values = {2};
  }
  keep_base_pixels({0}, base, 2, image);
  EXPECT_EQ(image.find("CryptoObject00.G")->values[0], 1);
  EXPECT_EQ(image.find("Z")->values[0], 2);
}

TEST(MatteChannels, WithoutTheGroupThereAreNone) {
  Stage stage;
  stage.add_square("Front", Json::object());
  stage.frame();
  Image image{kWidth, kHeight, {}, {}, {}, {}};
  const Scene scene = stage.maker.load();
  const Segment segment = segment_of(scene, 1, {});
  const SceneFrame frame = SegmentScene(scene, segment, {}).at(1);
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table(scene, segment, {}));
  add_matte_channels({tracer, lights}, CameraView(frame, stage.camera, kWidth, kHeight), stage.options, stage.rendered,
                     MatteNames(scene), {"RGBA", "id"}, image);
  EXPECT_TRUE(image.channels.empty() && image.text.empty());
}

}  // namespace
}  // namespace tempolux
