// Lamps with textures of emission and alpha: closed forms of the light that they send.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/lib/light/light_scene.h"
#include "tests/support/textured_scene.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::png_image;
using test::table_of;
using test::texture_of_image;

/// A quad of side 2 at z = 1 that faces down; u along x, v along y, from 0 to 1.
const std::vector<Vec3> kLamp{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}};
const std::vector<Vec2> kLampUvs{{0, 0}, {0, 1}, {1, 1}, {1, 0}};

/// Two texels: the left half at half the light, the right half dark; emission 2 where the texture is 1.
HandMadeScene half_dark_lamp(bool alpha = false) {
  HandMadeScene scene;
  Material lamp = matte(Rgb(0.0f), Rgb(2.0f));
  lamp.double_sided = false;
  lamp.textures.emplace();
  if (alpha) {
    lamp.alpha_mode = Material::Alpha::blend;
    lamp.textures->base_color = texture_of_image();
    scene.set_images({png_image(2, 1, 4, {255, 255, 255, 51, 255, 255, 255, 0})});  // alpha 0.2 and 0
  } else {
    lamp.textures->emission = texture_of_image();
    scene.set_images({png_image(2, 1, 3, {188, 188, 188, 0, 0, 0})});
  }
  scene.add_quad(kLamp[0], kLamp[1], kLamp[2], kLamp[3], lamp);
  scene.set_uvs(kLampUvs);
  return scene;
}
constexpr float kHalf = 0.502886f;  // sRGB code 188

TEST(EmissiveTexture, IrradianceIsThatOfTheBrightHalf) {
  // A sample L cos / pdf lies between 0 and about twice the mean. N = 2^14 samples are stratified in two dimensions
  // except at the edge of the texture: sigma is about 2 / sqrt(N) of the mean at worst, 1.6 %, and far less if
  // stratified.
  for (const bool alpha : {false, true}) {
    HandMadeScene scene = half_dark_lamp(alpha);
    const Lights lights(scene.frame(), table_of(scene));
    const double radiance = 2 * (alpha ? 0.2 : double(kHalf));
    for (const Vec3 point : {Vec3{0, 0, 0}, Vec3{-0.5f, 0.3f, 0.7f}, Vec3{3, 1, -2}}) {
      const Vec3 normal{0, 0, 1};
      const double expected =
          radiance * polygon_irradiance(point, normal, {{-1, -1, 1}, {-1, 1, 1}, {0, 1, 1}, {0, -1, 1}});
      double sum = 0;
      constexpr int kSide = 128;
      for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
          LightSample light;
          if (lights.sample(point, normal, {(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide}, light))
            sum += double(light.facing_irradiance.g) * double(std::max(0.0f, dot(light.wi, normal)));
        }
      EXPECT_NEAR(sum / (kSide * kSide), expected, 0.01 * expected) << alpha << " " << point.x;
    }
  }
}

TEST(EmissiveTexture, PhotonsCarryTheTexelsLight) {
  // pi L A of the bright half, 2 m^2. Half of the photons carry all flux: sigma = 1 / sqrt(N), 0.8 % for N = 2^14; here
  // the points form a lattice.
  for (const bool alpha : {false, true}) {
    HandMadeScene scene = half_dark_lamp(alpha);
    const Lights lights(scene.frame(), table_of(scene));
    const double expected = M_PI * 2 * (alpha ? 0.2 : double(kHalf)) * 2;
    double sum = 0;
    constexpr int kSide = 128;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        const std::array<double, 4> u = {(i + 0.5) / kSide, (j + 0.5) / kSide, 0.3, 0.6};
        const PhotonEmission photon = lights.emit(u);
        if (photon.origin.x > 0.01f) { EXPECT_EQ(photon.flux, Rgb(0.0f)); }
        sum += double(photon.flux.r) / (kSide * kSide);
      }
    EXPECT_NEAR(sum, expected, 0.01 * expected) << alpha;
    EXPECT_NEAR(lights.total_flux().r, expected, 0.05 * expected) << alpha;  // the mean by 64 points
  }
}

TEST(EmissiveTexture, TrianglesThatAreDarkAllOverAreNoLights) {
  HandMadeScene scene;
  Material lamp = matte(Rgb(0.0f), Rgb(2.0f));
  lamp.textures.emplace().emission = texture_of_image();
  scene.set_images({png_image(16, 1, 1, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 0, 0})});
  scene.add_quad(kLamp[0], kLamp[1], kLamp[2], kLamp[3], lamp);
  scene.set_uvs({{0, 0}, {0, 1}, {0.3f, 1}, {0.3f, 0}});
  EXPECT_EQ(mean_emission_share(scene.frame(), 0, 0), Rgb(0.0f));
  scene.set_uvs({{0, 0}, {0, 1}, {1, 1}, {1, 0}});
  EXPECT_NEAR(mean_emission_share(scene.frame(), 0, 0).r + mean_emission_share(scene.frame(), 0, 1).r, 2.0f / 8, 0.025);
}

// Textures with texels larger or smaller than the triangle: the mean that a few points give. A ramp from 0 to 1 over
// two texels, interpolated between their middles, has the mean of its value at the triangle's centroid. 4 or 400
// stripes of 0 and 1 have the mean 1/2.
TEST(EmissiveTexture, MeansOverATriangleOfAnySize) {
  const auto lamp = [](int texels, float left, float right) {
    HandMadeScene scene;
    Material material = matte(Rgb(0.0f), Rgb(2.0f));
    material.textures.emplace().emission = texture_of_image(0, false);
    std::vector<std::uint8_t> stripes;
    for (int i = 0; i < texels; ++i) stripes.insert(stripes.end(), 3, i % 2 ? 255 : 0);
    scene.set_images({png_image(texels, 1, 3, stripes)});
    scene.add_quad(kLamp[0], kLamp[1], kLamp[2], kLamp[3], material);
    scene.set_uvs({{left, 0}, {left, 1}, {right, 1}, {right, 0}});
    return std::array{mean_emission_share(scene.frame(), 0, 0).g, mean_emission_share(scene.frame(), 0, 1).g};
  };
  const auto [lower, upper] = lamp(2, 0.25f, 0.75f);
  EXPECT_NEAR(lower, 1.0 / 3, 1e-4);
  EXPECT_NEAR(upper, 2.0 / 3, 1e-4);
  // A stripe is at least two parts wide: a sixteenth of them lie in the wrong stripe, or a level of grey is 1/255.
  for (const int texels : {8, 800})
    for (const float mean : lamp(texels, 0, 1)) EXPECT_NEAR(mean, 0.5, 1.0 / 16) << texels;
}

/// kLamp, one-sided, of radiance 2 and with this alpha; MASK cuts at .5.
HandMadeScene lamp_of_alpha(Material::Alpha mode, float alpha) {
  HandMadeScene scene;
  Material lamp = matte(Rgb(0.0f), Rgb(2.0f));
  lamp.double_sided = false;
  lamp.alpha_mode = mode;
  lamp.alpha_cutoff = 0.5f;
  lamp.alpha = alpha;
  scene.add_quad(kLamp[0], kLamp[1], kLamp[2], kLamp[3], lamp);
  return scene;
}

// MASK with an animated alpha: in the first frame the lamp is invisible, in the second it is complete. Values that the
// table keeps from the first frame must not dim the second.
TEST(EmissiveTexture, MeansFollowTheMaterialsAlpha) {
  HandMadeScene hidden = lamp_of_alpha(Material::Alpha::mask, 0.4f), shown = lamp_of_alpha(Material::Alpha::mask, 0.6f);
  const std::vector<SceneFrame> frames{hidden.frame(), shown.frame()};
  const EmissionTable table = build_emission_table(frames);
  EXPECT_NEAR(Lights(frames[0], table).total_flux().r, 0.01 * 8 * M_PI,
              1e-4);  // the least share, for a lamp that is hidden completely
  EXPECT_NEAR(Lights(frames[1], table).total_flux().r, 8 * M_PI, 1e-4);
}

// BLEND whose alpha is 1 in the first frame and falls to .3: no texture and no alpha makes the first frame's emission
// vary, but the second frame's lamp lets only .3 of its emission be met, so samples and photons must not bring more.
TEST(EmissiveTexture, AlphaThatFallsDimsTheLamp) {
  HandMadeScene whole = lamp_of_alpha(Material::Alpha::blend, 1), faded = lamp_of_alpha(Material::Alpha::blend, 0.3f);
  const std::vector<SceneFrame> frames{whole.frame(), faded.frame()};
  const EmissionTable table = build_emission_table(frames);
  EXPECT_NEAR(Lights(frames[0], table).total_flux().r, 8 * M_PI, 1e-4);
  EXPECT_NEAR(Lights(frames[1], table).total_flux().r, 0.3 * 8 * M_PI, 1e-4);
}

/// kLamp with a texture of 32 x 32 texels, black but for three: white, grey (half), and white.
HandMadeScene lamp_of_texels(const std::array<float, 6>& transform = {1, 0, 0, 0, 1, 0},
                             const std::vector<Vec2>& uvs = kLampUvs) {
  constexpr std::size_t kSide = 32;
  HandMadeScene scene;
  Material lamp = matte(Rgb(0.0f), Rgb(2.0f));
  lamp.double_sided = false;
  lamp.textures.emplace().emission = texture_of_image();
  lamp.textures->emission.transform = transform;
  std::vector<std::uint8_t> texels(3 * kSide * kSide, 0);
  const auto set = [&](std::size_t x, std::size_t y, std::uint8_t code) {
    for (std::size_t c = 0; c < 3; ++c) texels[3 * (y * kSide + x) + c] = code;
  };
  set(3, 20, 255);
  set(4, 20, 188);
  set(25, 9, 255);
  scene.set_images({png_image(kSide, kSide, 3, texels)});
  scene.add_quad(kLamp[0], kLamp[1], kLamp[2], kLamp[3], lamp);
  scene.set_uvs(uvs);
  return scene;
}

// Three texels of 1024 shine. If the lamp were sampled evenly, 4 samples of 1000 would find light, and the mean square
// would be about 400 times the square of the mean. Sampled by parts of about a texel, half of each part's neighbours'
// area is dark at worst: below 5 times.
TEST(EmissiveTexture, SamplesAndPhotonsGoWhereTheTextureShines) {
  HandMadeScene scene = lamp_of_texels();
  const Lights lights(scene.frame(), table_of(scene));
  constexpr double kTexel = 4.0 / 1024;
  const Vec3 point{0.3f, -0.2f, -1}, normal{0, 0, 1};
  const auto expected_from = [&](float x, float y) {
    const Vec3 to = Vec3{x, y, 1} - point;
    return to.z * to.z / double(dot(to, to) * dot(to, to)) * kTexel;
  };
  const auto middle = [](int texel) { return -1 + (float(texel) + 0.5f) / 16; };
  const double expected =
                   2 * (expected_from(middle(3), middle(20)) + double(kHalf) * expected_from(middle(4), middle(20)) +
                        expected_from(middle(25), middle(9))),
               flux = M_PI * 2 * (2 + double(kHalf)) * kTexel;
  double sum = 0, square = 0, photons = 0, photon_square = 0;
  constexpr int kSide = 256;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vec2 u{(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide};
      LightSample light;
      if (lights.sample(point, normal, u, light)) {
        const double e = double(light.facing_irradiance.g) * double(std::max(0.0f, dot(light.wi, normal)));
        sum += e / (kSide * kSide);
        square += e * e / (kSide * kSide);
      }
      const double carried = double(lights.emit(std::array<double, 4>{u.x, u.y, 0.3, 0.6}).flux.g);
      photons += carried / (kSide * kSide);
      photon_square += carried * carried / (kSide * kSide);
    }
  EXPECT_NEAR(sum, expected, 0.01 * expected);
  EXPECT_NEAR(photons, flux, 0.01 * flux);
  EXPECT_LT(square, 5 * expected * expected);
  EXPECT_LT(photon_square, 5 * flux * flux);
}

// MIS weighs paths that hit the lamp by the density of light samples. That density is 0 only where the lamp is dark,
// and its integral over the lamp's solid angle is the probability that a sample is drawn, 1. sample() and
// pdf_solid_angle() agree. Also for a texture that is turned, repeated or mirrored, for coordinates that are all
// alike, and for coordinates that are not numbers.
TEST(EmissiveTexture, DensityOfPartsHasTheIntegralOne) {
  const float nan = std::nanf("");
  const std::vector<Vec2> alike(4, {0.1f, 0.64f}), lost(4, {nan, nan});
  std::vector<HandMadeScene> scenes;
  scenes.push_back(lamp_of_texels());
  scenes.push_back(lamp_of_texels({0.6f, 0.8f, 0.1f, -0.8f, 0.6f, 0.3f}));
  scenes.push_back(lamp_of_texels({3, 0, 0.5f, 0, -2, 0.2f}));
  scenes.push_back(lamp_of_texels({1e9f, 0, 0, 0, 1e9f, 0}));
  scenes.push_back(lamp_of_texels({1, 0, 0, 0, 1, 0}, alike));
  scenes.push_back(lamp_of_texels({1, 0, 0, 0, 1, 0}, lost));
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const SceneFrame& frame = scenes[n].frame();
    const Lights lights(frame, build_emission_table({&frame, 1}));
    const Vec3 point{0.1f, 0.4f, -0.5f}, normal{0, 0, 1};
    if (n == 5 && lights.total_flux().g == 0) continue;  // reads one texel, which is black
    double integral = 0;
    constexpr int kSide = 512;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        const float b1 = (float(i) + 0.5f) / kSide, b2 = (float(j) + 0.37f) / kSide;
        if (b1 + b2 >= 1) continue;
        for (std::uint32_t triangle = 0; triangle < 2; ++triangle) {
          const auto& corners = frame.surfaces[0].primitive->triangles[triangle];
          const Vec3 p0 = frame.surfaces[0].position(corners[0]),
                     at = p0 + (frame.surfaces[0].position(corners[1]) - p0) * b1 +
                          (frame.surfaces[0].position(corners[2]) - p0) * b2,
                     to = at - point;
          const double pdf = double(lights.pdf_solid_angle(point, normal, 0, triangle, at)), d2 = double(dot(to, to));
          integral += pdf * double(to.z) / (d2 * std::sqrt(d2)) * 4 / (kSide * kSide);
          if (n == 0 && emission_at(frame, 0, triangle, b1, b2, 0).g > 0) { EXPECT_GT(pdf, 0) << at.x << " " << at.y; }
        }
      }
    EXPECT_NEAR(integral, 1, 0.02) << n;
    for (int i = 0; i < 200; ++i) {
      LightSample light;
      if (!lights.sample(point, normal, Vec2{(float(i) + 0.5f) / 200, float(i * 83 % 200) / 200}, light)) continue;
      const double first = double(lights.pdf_solid_angle(point, normal, 0, 0, light.position)),
                   second = double(lights.pdf_solid_angle(point, normal, 0, 1, light.position)),
                   pdf = double(light.pdf_solid_angle);
      EXPECT_LT(std::min(std::abs(first / pdf - 1), std::abs(second / pdf - 1)), 1e-3) << n << " " << i;
    }
  }
}

}  // namespace
}  // namespace tempolux
