// Light that no camera path finds: a point lamp and its mirror image.
#include "lib/pilot/hidden_light.h"

#include <gtest/gtest.h>

#include "lib/material/smooth_material.h"
#include "lib/pilot/pilot_photons.h"
#include "lib/pilot/see_photons.h"
#include "tests/support/frames.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

constexpr double kReflectance = 0.5;

Material mirror(float roughness = 0) {
  Material m = test::matte(Rgb(1.0f));
  m.metallic = 1;
  m.roughness = roughness;
  return m;
}

/// A black square that shines from its front alone.
Material one_sided(Rgb radiance) {
  Material m = test::matte(Rgb(0.0f), radiance);
  m.double_sided = false;
  return m;
}

/// A matte floor at z = 0, of which from_above() sees 2 x 1.125 m from z = 1. 20 m of mirror hang at z = 2, and a lamp
/// of 1 W/sr at z = 1.5 has its image at z = 2.5.
struct UnderAMirror {
  test::HandMadeScene scene;
  explicit UnderAMirror(const Material& ceiling, float intensity = 1) {
    scene.add_quad({-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}, test::matte(Rgb(float(kReflectance))));
    scene.add_quad({-10, 10, 2}, {10, 10, 2}, {10, -10, 2}, {-10, -10, 2}, ceiling);
    scene.add_point_light({0, 0, 1.5f}, Rgb(intensity));
  }
  /// Instead of the point lamp a square of side kSide at its place, which faces up.
  static UnderAMirror with_square() {
    UnderAMirror room(mirror(), 0);
    constexpr float r = kSide / 2;
    room.scene.add_quad({-r, -r, 1.5f}, {r, -r, 1.5f}, {r, r, 1.5f}, {-r, r, 1.5f},
                        one_sided(Rgb(1 / (kSide * kSide))));
    return room;
  }
  static constexpr float kSide = 0.02f;
  double share(double picture) {
    const SceneFrame& frame = scene.frame();
    const Tracer tracer(frame);
    const EmissionTable table = build_emission_table({&frame, 1});
    const Lights all(frame, table), without_extent(frame, table, Lights::Which::punctual);
    return hidden_share({tracer, all}, without_extent, test::from_above(), picture);
  }
  /// Mean radiance of the picture by a lamp at height h: rho / pi I h / d^3, over the 64 x 36 pixels. A small square of
  /// 1 W/sr along its normal has I = h / d.
  static double by_lamp_at(double h, bool square = false) {
    double sum = 0;
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 36; ++j) {
        const double x = (i - 31.5) / 32, y = (j - 17.5) / 32, d = std::sqrt(x * x + y * y + h * h);
        sum += kReflectance / M_PI * h / (d * d * d) * (square ? h / d : 1);
      }
    return sum / (64 * 36);
  }
};

TEST(HiddenLight, NeedsALampWithoutExtentAndAMirror) {
  EXPECT_TRUE(may_hide_light(UnderAMirror(mirror()).scene.frame()));
  EXPECT_FALSE(may_hide_light(UnderAMirror(mirror(), 0).scene.frame()));
  EXPECT_FALSE(may_hide_light(UnderAMirror(test::matte(Rgb(1.0f))).scene.frame()));
  EXPECT_TRUE(may_hide_light(UnderAMirror(mirror(0.05f)).scene.frame())) << "one path in 40000 meets the lamp";
  EXPECT_FALSE(may_hide_light(UnderAMirror(mirror(0.2f)).scene.frame())) << "one in 160";
}

/// Light goes straight through a smooth thin wall. A solid of the same glass bends light.
TEST(HiddenLight, PanesAreSmoothAndCanBeLeftOut) {
  Material glass = test::matte(Rgb(1.0f));
  glass.transmission = 1, glass.roughness = 0;
  for (const bool thin : {true, false}) {
    glass.thin_walled = thin;
    UnderAMirror room(glass);
    EXPECT_NE(first_smooth_material(room.scene.frame()), kNone);
    EXPECT_EQ(first_smooth_material(room.scene.frame(), false) == kNone, thin);
  }
}

/// The image's light over that of the lamp and its image. Of 32768 light paths one in 70 reaches the picture by way of
/// the mirror: 5 % of noise if the paths were independent, three of them are allowed. Photons on the floor outside of
/// the picture or a share of the lamp's own light would be off by more than half.
TEST(HiddenLight, ShareOfAMirrorImage) {
  UnderAMirror room(mirror());
  const double image = UnderAMirror::by_lamp_at(2.5), whole = image + UnderAMirror::by_lamp_at(1.5);
  EXPECT_NEAR(room.share(whole) / (image / whole), 1, 0.15);
}

/// Means by layer: of what add_hidden_light() finds, of a path-traced picture, and of caustic and indirect light by the
/// photons of the whole lamp.
struct Found {
  std::array<double, kLayerCount> hidden{}, paths{};
  SeenLight photons;
  Found(UnderAMirror& room, std::uint64_t seed, Lights::Which which = Lights::Which::punctual) {
    const SceneFrame& frame = room.scene.frame();
    const Tracer tracer(frame);
    const EmissionTable table = build_emission_table({&frame, 1});
    const Lights all(frame, table), lamps(frame, table, which);
    RenderScene scene{tracer, all};
    scene.without_hidden_light = which == Lights::Which::lamps;
    EXPECT_TRUE(light_paths_find(frame, table));
    LayerImage picture;
    picture.pixels.resize(64 * 36);
    add_hidden_light(scene, lamps, test::from_above(), 1 << 20, seed, picture);
    add(picture, hidden);
    FrameOptions options;
    options.samples = 64;
    add(render_frame(scene, test::from_above(), options).mean, paths);
    photons = see_photons(scene, test::from_above(), pilot_photons(tracer, all, "caustic,indirect", 1 << 20, 7));
  }
  static void add(const LayerImage& picture, std::array<double, kLayerCount>& means) {
    for (const Layers& pixel : picture.pixels)
      for (std::size_t l = 0; l < kLayerCount; ++l) means[l] += channel_mean(Rgbd(pixel.value[l])) / (64 * 36);
  }
};

/// The image's light is the layer caustic: of a million light paths 15 000 reach the picture by way of the mirror, .8 %
/// of noise, three of them are allowed. Hidden light and camera paths together are the indirect light of all photons:
/// light that met the floor before the mirror is found by camera paths, so hidden light must not hold it.
TEST(HiddenLight, CompletesThePictureOfCameraPaths) {
  UnderAMirror room(mirror());
  const Found found(room, 1);
  const auto caustic = std::size_t(Layer::caustic), indirect = std::size_t(Layer::indirect);
  EXPECT_NEAR(found.hidden[caustic] / UnderAMirror::by_lamp_at(2.5), 1, 0.025);
  EXPECT_EQ(found.paths[caustic], 0);
  EXPECT_EQ(found.hidden[std::size_t(Layer::direct)], 0);
  EXPECT_NEAR((found.hidden[indirect] + found.paths[indirect]) / found.photons.indirect.mean, 1, 0.04);
  EXPECT_GT(found.hidden[indirect], 0.1 * found.photons.indirect.mean);
}

/// A small square lamp has no light twice and misses none: light paths add what camera paths leave out, and no more.
/// Light of the square that the camera paths still held would be off by 1 in layer caustic. Tolerances as above; the
/// square of 2 cm is a point within 1e-4.
TEST(HiddenLight, LightPathsAddWhatCameraPathsLeaveOutOfSmallLamps) {
  UnderAMirror room = UnderAMirror::with_square();
  const Found found(room, 1, Lights::Which::lamps);
  const auto caustic = std::size_t(Layer::caustic), indirect = std::size_t(Layer::indirect);
  EXPECT_NEAR(found.hidden[caustic] / UnderAMirror::by_lamp_at(2.5, true), 1, 0.025);
  EXPECT_EQ(found.paths[caustic], 0);
  EXPECT_NEAR((found.hidden[indirect] + found.paths[indirect]) / found.photons.indirect.mean, 1, 0.04);
}

TEST(HiddenLight, SeedsAreIndependent) {
  UnderAMirror room(mirror());
  EXPECT_NE(Found(room, 1).hidden[std::size_t(Layer::caustic)], Found(room, 2).hidden[std::size_t(Layer::caustic)]);
}

/// All light is missed in a black picture. A share below the limit of the audit is no share.
TEST(HiddenLight, BlackAndBrightPictures) {
  UnderAMirror room(mirror());
  EXPECT_EQ(room.share(0), 1);
  EXPECT_EQ(room.share(1e3), 0);
}

}  // namespace
}  // namespace tempolux
