// Photons seen by the camera against closed forms; their standard error; biases that exist and biases that do not.
#include "lib/audit/audit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/closed_box.h"
#include "tests/support/frames.h"
#include "tests/support/chain.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::Lit;
using test::matte;

constexpr int kWidth = 64, kHeight = 36;
constexpr std::size_t kPixels = kWidth * kHeight;

/// Looks along -z from `eye`, 90 degrees high: pixels at the border are far from the axis, where a wrong power of the
/// cosine shows.
CameraView wide_view(Vec3d eye) {
  PlacedCamera camera;
  camera.camera.kind = Camera::Kind::perspective;
  camera.camera.yfov_rad = 1.5707963f;
  camera.scene_from_camera.translation = eye;
  return CameraView(camera, {}, kWidth, kHeight);
}

/// A frame with one layer of uniform radiance.
RenderedFrame even_frame(Layer layer, float radiance) {
  RenderedFrame frame;
  frame.mean.width = kWidth;
  frame.mean.height = kHeight;
  frame.mean.pixels.resize(kPixels);
  for (Layers& pixel : frame.mean.pixels) pixel[layer] = Rgb(radiance);
  return frame;
}

std::vector<AuditEntry> audit(const Lit& lit, const CameraView& view, const RenderedFrame& frame, std::uint64_t paths,
                              std::uint64_t seed = 1) {
  const std::vector<std::uint32_t> objects(kPixels, 0);
  FrameAudit audit(view, frame, objects, {});
  audit.add_photons(lit.tracer, lit.lights, {.photon_paths = paths, .seed = seed});
  return audit.entries();
}

const AuditEntry* find(const std::vector<AuditEntry>& entries, Layer layer, const std::string& part) {
  for (const AuditEntry& entry : entries)
    if (entry.layer == layer && entry.part == part) return &entry;
  return nullptr;
}

/// A plane of 45 degrees, z = y - 2, under a lamp of 3 W/sr at (0, 1, 0), seen from the origin: radiance rho I cos /
/// (pi d^2) at each place. The expected value is taken at the middles of pixels, with an error below .1 % of the mean.
/// A wrong power of the cosine to the axis makes a difference of 20 to 40 % at the sides; so does a distance in place
/// of the depth.
TEST(PhotonSplats, ObliquePlaneUnderALamp) {
  HandMadeScene made;
  made.add_quad({-60, -30, -32}, {60, -30, -32}, {60, 1.9f, -0.1f}, {-60, 1.9f, -0.1f}, matte(Rgb(0.6f)));
  made.add_point_light({0, 1, 0}, Rgb(3.0f));
  const Lit lit(made.frame());
  const CameraView view = wide_view({});
  std::array<double, 4> column{};  // means over quarters of the picture, left to right
  const Vec3 normal = normalize(Vec3{0, -1, 1}), lamp{0, 1, 0};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 ray = view.middle(x, y).direction;
      const float t = -2 / (ray.z - ray.y);
      const Vec3 at = ray * t;
      if (!(t > 0) || std::abs(at.x) > 60 || at.y > 1.9f || at.y < -30) continue;
      const Vec3 to_lamp = lamp - at;
      const float d2 = dot(to_lamp, to_lamp);
      column[std::size_t(x * 4 / kWidth)] +=
          double(0.6f * 3 / kPi * std::abs(dot(to_lamp, normal)) / std::sqrt(d2) / d2) / (kPixels / 4);
    }
  std::array<double, 4> found{}, error{};
  const std::vector<AuditEntry> entries = audit(lit, view, even_frame(Layer::emission, 1), 400'000);
  for (const AuditEntry& entry : entries)
    if (entry.layer == Layer::direct && entry.part.starts_with("tile")) {
      const auto i = std::size_t(entry.part[5] - '1');
      found[i] += entry.light.value / 4;
      error[i] += entry.light.error * entry.light.error / 16;
    }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found[i] / column[i], 1, 4 * std::sqrt(error[i]) / column[i] + 0.01)
        // Tiles with fewer than 32 photons are not reported: they are far away and hold below .5 % of the light.
        << i;
    EXPECT_LT(std::sqrt(error[i]) / column[i], 0.02);
  }
}

/// In a sphere, light that was reflected once or more is uniform: E = F rho / (S (1 - rho)), seen as rho E / pi. A
/// polyhedron of 1152 faces has .6 % less area S. Over 24 seeds the standard errors are right: (splats - exact) / error
/// is Student's t with 31 degrees of freedom, because the error is that of 32 maps. Its square has the mean 31 / 29 and
/// the deviation 1.6; over 384 values, 16 tiles of 24 seeds, 4 sigma are .33. If parts of one map counted as samples,
/// the mean would be below .1, because each part holds starts of one kind.
TEST(PhotonSplats, SphereIsLitEvenlyAndTheErrorIsKnown) {
  test::ClosedBox box(test::Shape::sphere, 0.5f, Rgb(1.0f));
  const SceneFrame& frame = box.scene.frame();
  const CameraView view = wide_view({0.1, -0.2, 0.3});
  const double surface = test::AreaSampler(frame).area(),
               exact = 0.5 / 3.14159265 * double(box.flux.g) * 0.5 / (surface * 0.5);
  double sum = 0, variance = 0, z2 = 0;
  int tiles = 0, far = 0;
  const Lit lit(frame);
  constexpr int kSeeds = 24;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<AuditEntry> entries = audit(lit, view, even_frame(Layer::indirect, float(exact)), 20'000, seed);
    const AuditEntry* const picture = find(entries, Layer::indirect, "picture");
    ASSERT_TRUE(picture);
    sum += picture->light.value / exact;
    variance += picture->light.error * picture->light.error / (exact * exact);
    EXPECT_FALSE(is_biased(*picture));
    for (const AuditEntry& entry : entries)
      if (entry.layer == Layer::indirect && entry.part.starts_with("tile")) {
        const double z = (entry.light.value - exact) / entry.light.error;
        z2 += z * z;
        ++tiles;
        far += std::abs(z) > 3;
      }
  }
  EXPECT_NEAR(sum / kSeeds, 1, 4 * std::sqrt(variance) / kSeeds + 0.002);
  EXPECT_LT(std::sqrt(variance / kSeeds), 0.02);
  EXPECT_EQ(tiles, kSeeds * 16);
  EXPECT_NEAR(z2 / tiles, 31.0 / 29, 0.33);
  EXPECT_LE(far, 8);
}

/// The camera in front of a sheet does not see light on its back.
TEST(PhotonSplats, TheOtherSideOfAThinWallIsDark) {
  HandMadeScene made;
  made.add_quad({-50, -50, -1}, {50, -50, -1}, {50, 50, -1}, {-50, 50, -1}, matte(Rgb(0.6f)));
  made.add_point_light({0, 0, -2}, Rgb(3.0f));
  EXPECT_TRUE(
      audit(Lit(made.frame()), wide_view({}), even_frame(Layer::emission, 1), 20'000).empty());  // no photon is in view
}

/// The audit finds a frame whose indirect light is a tenth too dark and does not report a correct one. The share refers
/// to the light of the picture.
TEST(FrameAudit, FindsALayerThatIsTooDark) {
  test::ClosedBox box(test::Shape::sphere, 0.5f, Rgb(1.0f));
  const SceneFrame& frame = box.scene.frame();
  const CameraView view = wide_view({0.1, -0.2, 0.3});
  const double exact = 0.5 / 3.14159265 * double(box.flux.g) / test::AreaSampler(frame).area();
  const Lit lit(frame);
  RenderedFrame dark = even_frame(Layer::indirect, float(0.9 * exact));
  for (Layers& pixel : dark.mean.pixels) pixel[Layer::direct] = Rgb(float(1.1 * exact));  // the picture is 2 exact
  const AuditEntry entry = *find(audit(lit, view, dark, 300'000), Layer::indirect, "picture");
  EXPECT_NEAR(entry.of_layer(), -0.1, 4 * entry.of_layer_error());
  EXPECT_LT(entry.of_layer_error(), 0.006);
  EXPECT_NEAR(entry.share(), -0.05, 4 * entry.share_error());
  EXPECT_TRUE(is_biased(entry));
  EXPECT_FALSE(is_biased(
      *find(audit(lit, view, even_frame(Layer::indirect, float(exact)), 300'000), Layer::indirect, "picture")));
}

/// A plane under a lamp and a sun. The audit takes the lamp's light from photons and the sun's from camera paths. A
/// frame with both is right; one that lacks the sun is not. With photons of both lights the sun would count twice.
TEST(FrameAudit, EachLightIsFoundOnce) {
  HandMadeScene made;
  made.add_quad({-60, -30, -32}, {60, -30, -32}, {60, 1.9f, -0.1f}, {-60, 1.9f, -0.1f}, matte(Rgb(0.6f)));
  made.add_point_light({0, 1, 0}, Rgb(3.0f));
  made.add_sun({0, -0.6f, -0.8f}, Rgb(0.5f));
  const SceneFrame& frame = made.frame();
  const EmissionTable table = build_emission_table({&frame, 1});
  const Tracer tracer(frame);
  const Lights all(frame, table), lamp(frame, table, Lights::Which::placed), sun(frame, table, Lights::Which::distant);
  EXPECT_FALSE(lamp.has_distant());
  EXPECT_FALSE(sun.has_placed());
  const CameraView view = wide_view({});
  FrameOptions options;
  options.samples = 16;
  const std::vector<std::uint32_t> objects(kPixels, 0);
  const auto direct = [&](const Lights& of_frame) {
    const RenderedFrame rendered = render_frame({tracer, of_frame, of_frame.has_suns()}, view, options);
    FrameAudit audit(view, rendered, objects, {});
    audit.add_photons(tracer, lamp, {.photon_paths = 200'000, .seed = 1});
    audit.add_paths({tracer, sun, true}, {.eye_paths = 20'000, .seed = 1});
    const std::vector<AuditEntry> entries = audit.entries();
    const AuditEntry* const picture = find(entries, Layer::direct, "picture");
    return picture ? *picture : AuditEntry{};
  };
  const AuditEntry right = direct(all), dark = direct(lamp);
  ASSERT_TRUE(right.bias.known() && dark.bias.known());
  EXPECT_NEAR(right.bias.value, 0, 4 * right.bias.error);
  EXPECT_LT(right.of_layer_error(), 0.02);
  EXPECT_LT(dark.bias.value, -10 * dark.bias.error);
  EXPECT_TRUE(is_biased(dark));
}

/// A room whose back wall is a mirror, lit by a panel that the mirror shows. The audit's photons find what a frame by
/// paths shows on walls in the mirror. A frame that shows a fifth less there, with the panel as bright as before, is
/// found.
TEST(FrameAudit, MirrorsShowLightThatIsTooDark) {
  HandMadeScene made;
  made.add_room({-2, -2, -2}, {2, 2, 2}, matte(Rgb(0.5f)));
  made.add_quad({-1, 1.9f, 1}, {-1, 1.9f, -1}, {1, 1.9f, -1}, {1, 1.9f, 1}, matte(Rgb(0.0f), Rgb(20.0f)));
  Material mirror;
  mirror.metallic = 1;
  mirror.roughness = 0;
  mirror.base_color = Rgb(0.9f);
  made.add_quad({-1.8f, -1.8f, -1.9f}, {1.8f, -1.8f, -1.9f}, {1.8f, 1.8f, -1.9f}, {-1.8f, 1.8f, -1.9f}, mirror);
  const SceneFrame& frame = made.frame();
  const Lit lit(frame);
  const CameraView view = wide_view({0.1, -0.2, 1.3});
  FrameOptions options;
  options.samples = 32;
  const std::vector<std::uint32_t> objects(kPixels, 0);
  RenderedFrame rendered = render_frame(lit.scene(), view, options);
  const SpecularHits hits(lit.scene(), view, {}, 20'000, 5);
  const auto specular = [&] {
    FrameAudit audit(view, rendered, objects, {});
    audit.add_photons(lit.tracer, lit.lights, {.photon_paths = 100'000, .seed = 1}, &hits);
    const std::vector<AuditEntry> entries = audit.entries();
    const AuditEntry* const picture = find(entries, Layer::specular, "picture");
    return picture ? *picture : AuditEntry{};
  };
  const AuditEntry right = specular();
  ASSERT_TRUE(right.bias.known());
  EXPECT_NEAR(right.of_layer(), 0, 4 * right.of_layer_error()) << right.light.value;
  EXPECT_LT(right.of_layer_error(), 0.03);
  for (Layers& pixel : rendered.mean.pixels)
    pixel[Layer::specular] = pixel[Layer::specular] * 0.8f + Rgb(0.2f * pixel.mirrored);
  const AuditEntry dark = specular();
  EXPECT_NEAR(dark.of_layer(), -0.2, 4 * dark.of_layer_error());
  EXPECT_TRUE(is_biased(dark));
}

/// A lamp behind the camera lights a wall and a card close to the camera. The card has two fifths of the light and
/// meets two of 2000 photons. Audits in which no photon met the card know their error, and it must cover what they
/// miss. The error of the photons that they did meet is ten times smaller.
TEST(FrameAudit, ErrorCoversRarePhotonsCloseToTheCamera) {
  HandMadeScene made;
  made.add_quad({-9, -6, -4}, {9, -6, -4}, {9, 6, -4}, {-9, 6, -4}, matte(Rgb(0.6f)));
  made.add_quad({-0.1f, -0.1f, -0.3f}, {0.1f, -0.1f, -0.3f}, {0.1f, 0.1f, -0.3f}, {-0.1f, 0.1f, -0.3f},
                matte(Rgb(0.6f)));
  made.add_point_light({0, 1, 1}, Rgb(3.0f));
  const Lit lit(made.frame());
  const CameraView view = wide_view({});
  FrameOptions options;
  options.samples = 16;
  const RenderedFrame right = render_frame({lit.tracer, lit.lights, false}, view, options);
  int known = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const std::vector<AuditEntry> entries = audit(lit, view, right, 2000, seed);
    if (const AuditEntry* const entry = find(entries, Layer::direct, "picture")) {
      ++known;
      EXPECT_FALSE(is_biased(*entry)) << entry->of_layer() << " +- " << entry->of_layer_error();
    }
  }
  EXPECT_EQ(known, 100);
}

/// If known light says that indirect light is 0, the bias is all of the indirect light: paths find it within 4 of their
/// standard errors, against a picture of 64 samples. Few paths give no standard error.
TEST(FrameAudit, PathsSayWhatIsMissing) {
  const test::Cornell c;
  const test::NoLight none(c.tracer);
  FrameOptions options;
  options.samples = 64;
  const RenderedFrame reference = render_frame(c.render_scene(), c.view, options);
  double indirect = 0;
  for (const Layers& pixel : reference.mean.pixels) indirect += channel_mean(Rgbd(pixel[Layer::indirect])) / kPixels;
  options.samples = 4;
  options.known = &none.known;
  const RenderedFrame dark = render_frame(c.render_scene(), c.view, options);
  const std::vector<std::uint32_t> objects(kPixels, 0);
  FrameAudit audit(c.view, dark, objects, {}), few(c.view, dark, objects, {});
  audit.add_paths(c.render_scene(), {.eye_paths = 20'000});
  const std::vector<AuditEntry> entries = audit.entries();
  const AuditEntry* const missing = find(entries, Layer::indirect, "picture");
  ASSERT_TRUE(missing);
  EXPECT_NEAR(missing->bias.value, -indirect, 4 * missing->bias.error + 0.005 * indirect);
  EXPECT_LT(missing->bias.error, 0.04 * indirect);
  EXPECT_TRUE(is_biased(*missing));
  few.add_paths(c.render_scene(), {.eye_paths = 32});
  EXPECT_TRUE(few.entries().empty());
}

}  // namespace
}  // namespace tempolux
