// Light and textures: closed forms for emission, coverage, normal maps, unlit surfaces and reflectance that varies over
// a surface.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/points/irradiance_points.h"
#include "lib/light/lights.h"
#include "lib/render/known_light.h"
#include "lib/render/path_tracer.h"
#include "lib/scene/texture_lookup.h"
#include "tests/lib/light/light_scene.h"
#include "tests/support/materials.h"
#include "tests/support/png_bytes.h"
#include "tests/support/photons.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::png_image;
using test::texture_of_image;

EmissionTable table_of(HandMadeScene& scene) { return build_emission_table({&scene.frame(), 1}); }

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

/// A horizontal square of side 2 at z = 0 of a material with alpha; u along x, v along y.
HandMadeScene veil(Material::Alpha mode, float alpha, bool textured) {
  HandMadeScene scene;
  Material material = matte(Rgb(0.5f));
  material.alpha_mode = mode;
  material.alpha = alpha;
  if (textured) {
    material.textures.emplace().base_color = texture_of_image();
    scene.set_images({png_image(2, 1, 4, {255, 255, 255, 204, 255, 255, 255, 51})});  // 0.8 and 0.2
  }
  scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, material);
  scene.set_uvs({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  return scene;
}

/// Share of downward rays that meet the veil, in its left (x < 0) or right half; both kinds of query.
double met(const Tracer& tracer, float x, bool occlusion) {
  constexpr int kRays = 20000;
  int count = 0;
  for (int i = 0; i < kRays; ++i) {
    const float y = -0.9f + 1.8f * float(i) / kRays;
    const Ray ray{{x, y, 1}, {0.01f, 0, -1}, 0, INFINITY};
    Hit hit;
    count += occlusion ? tracer.occluded(ray) : tracer.intersect(ray, hit);
  }
  return double(count) / kRays;
}

TEST(Alpha, BlendMeetsTheShareAlphaOfTheRays) {
  // 4 sigma of 20000 draws: 4 sqrt(0.25 / 20000) = 0.0141
  for (const bool occlusion : {false, true}) {
    for (const float alpha : {0.0f, 0.3f, 0.75f}) {
      HandMadeScene scene = veil(Material::Alpha::blend, alpha, false);
      EXPECT_NEAR(met(Tracer(scene.frame()), 0.4f, occlusion), alpha, 0.0141);
    }
    HandMadeScene scene = veil(Material::Alpha::blend, 0.5f, true);
    const Tracer tracer(scene.frame());
    EXPECT_NEAR(met(tracer, -0.5f, occlusion), 0.4, 0.0141);
    EXPECT_NEAR(met(tracer, 0.5f, occlusion), 0.1, 0.0141);
  }
}

/// Red at y = -1, green at y = 1: linear in between, times the factor. Roughness and all other properties stay.
TEST(VertexColours, MultiplyBaseColour) {
  HandMadeScene scene;
  Material material = matte({0.8f, 0.4f, 0.6f});
  material.textures.emplace().vertex_colors = true;
  scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, material);
  scene.set_colors({{1, 0, 1, 1}, {1, 0, 1, 1}, {0, 1, 1, 0}, {0, 1, 1, 0}});
  scene.add_quad({2, -1, 0}, {4, -1, 0}, {4, 1, 0}, {2, 1, 0}, material);  // the same material, no colours
  const Tracer tracer(scene.frame());
  const auto colour_at = [&](float x, float y) {
    Hit hit;
    EXPECT_TRUE(tracer.intersect({{x, y, 1}, {0, 0, -1}, 0, INFINITY}, hit)) << "opaque whatever the alpha";
    SurfacePoint point = tracer.surface_point(hit);
    return SurfaceMaterial(scene.frame(), point, 0).values().base_color;
  };
  for (const float x : {-0.7f, 0.6f})  // in either triangle
    for (const auto& [channel, expected] : {std::pair{&Rgb::r, 0.25f * 0.8f}, {&Rgb::g, 0.75f * 0.4f}, {&Rgb::b, 0.6f}})
      EXPECT_NEAR(colour_at(x, 0.5f).*channel, expected, 1e-6f) << x;
  EXPECT_EQ(colour_at(3, 0.5f), (Rgb{0.8f, 0.4f, 0.6f}));
}

/// Alpha .2 below, .6 above, times the texture's: .8 on the left, .2 on the right. 4 sigma of 20000 draws as above.
TEST(VertexColours, MultiplyAlpha) {
  for (const bool textured : {false, true})
    for (const bool occlusion : {false, true}) {
      HandMadeScene scene = veil(Material::Alpha::blend, 1, textured);
      scene.set_colors({{1, 1, 1, 0.2f}, {1, 1, 1, 0.2f}, {1, 1, 1, 0.6f}, {1, 1, 1, 0.6f}});
      SceneFrame frame = scene.frame();
      if (!textured) frame.materials[0].textures.emplace();
      frame.materials[0].textures->vertex_colors = true;
      const Tracer tracer(frame);
      EXPECT_NEAR(met(tracer, -0.5f, occlusion), 0.4 * (textured ? 0.8 : 1), 0.0141);
      EXPECT_NEAR(met(tracer, 0.5f, occlusion), 0.4 * (textured ? 0.2 : 1), 0.0141);
    }
  HandMadeScene mask = veil(Material::Alpha::mask, 1, false);
  mask.set_colors({{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}});  // from left to right
  SceneFrame frame = mask.frame();
  frame.materials[0].textures.emplace().vertex_colors = true;
  const Tracer tracer(frame);
  EXPECT_EQ(met(tracer, -0.1f, false), 0);
  EXPECT_EQ(met(tracer, 0.1f, false), 1);
}

TEST(Alpha, ARayHasOneFateHoweverItIsAsked) {
  HandMadeScene scene = veil(Material::Alpha::blend, 0.5f, false);
  const Tracer tracer(scene.frame()), another(scene.frame());
  for (int i = 0; i < 200; ++i) {
    const Ray ray{{0.003f * float(i) - 0.4f, 0.2f, 1}, {0, 0, -1}, 0, INFINITY};
    Hit hit;
    const bool first = tracer.intersect(ray, hit);
    EXPECT_EQ(first, tracer.occluded(ray));
    EXPECT_EQ(first, another.intersect(ray, hit));
  }
}

TEST(Alpha, RaysThatMeasureAVeilMeetItAlwaysOneByOneAndInLists) {
  HandMadeScene scene = veil(Material::Alpha::blend, 0.01f, false);
  const Tracer tracer(scene.frame());
  std::vector<Ray> rays;
  for (int i = 0; i < 40; ++i)
    rays.push_back({{0.02f * float(i) - 0.4f, 0.2f, 1}, {0, 0, -1}, 0, INFINITY, i % 2 == 0});
  std::vector<Hit> hits(rays.size());
  tracer.intersect(rays, hits);
  int met_by_chance = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    EXPECT_EQ(tracer.intersect(rays[i], hit), hits[i].surface != kNone) << i;
    if (rays[i].all_blend) EXPECT_EQ(hits[i].surface, 0u) << i;
    else met_by_chance += hits[i].surface != kNone;
  }
  EXPECT_LE(met_by_chance, 3);  // 20 draws of 0.01: more than 3 once in 25 000 scenes
}

TEST(Alpha, MaskIsThereOrNot) {
  for (const bool occlusion : {false, true}) {
    HandMadeScene scene = veil(Material::Alpha::mask, 1, true);  // cut-off 0.5
    const Tracer tracer(scene.frame());
    EXPECT_EQ(met(tracer, -0.5f, occlusion), 1);
    EXPECT_EQ(met(tracer, 0.5f, occlusion), 0);
    HandMadeScene half = veil(Material::Alpha::mask, 0.5f, false);
    EXPECT_EQ(met(Tracer(half.frame()), 0.5f, occlusion), 1);  // alpha = cut-off: there
  }
}

TEST(Alpha, HalfTransparentQuadBeforeALampDimsItByAlpha) {
  HandMadeScene scene = veil(Material::Alpha::blend, 0.4f, false);
  scene.add_quad({-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}, matte(Rgb(0.6f)));
  scene.add_point_light({0, 0, 3}, Rgb(10.0f));
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  // Straight below, seen from the side under the veil: direct light is 0.6 (albedo/pi I / d^2). N = 40000 draws with
  // probability 0.6: sigma = sqrt(0.4 / 0.6 / N) = 0.4 %.
  double direct = 0;
  constexpr int kSamples = 40000;
  RayCounts counts;
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 eye{2, 0.0001f * float(i % 200), -0.5f}, target{0.0002f * float(i / 200), 0.001f, -1};
    const Layers layers = trace_eye_path({tracer, lights}, {eye, normalize(target - eye), 0, INFINITY},
                                         PixelRandom(1, 7, std::uint32_t(i)), nullptr, counts);
    direct += double(layers[Layer::direct].g) / kSamples;
  }
  const double expected = 0.6 * (0.6 / M_PI * 10 / 16);
  EXPECT_NEAR(direct, expected, 4 * 0.004 * expected);
}

TEST(Alpha, PhotonsOnAVeilStandForAllThatArrive) {
  // A veil of alpha 0.25 under a point light on its axis: the flux that arrives is that of the solid angle of the
  // square, for any alpha. From height 1 above its centre a square of side 2 fills a sixth of the sphere: 4 pi I / 6.
  HandMadeScene scene = veil(Material::Alpha::blend, 0.25f, false);
  scene.add_point_light({0, 0, 1}, Rgb(1.0f));
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  PhotonOptions options;
  options.photon_count = 200'000;
  const PhotonTracer photons(tracer, lights, options);
  double sum = 0;
  for (const formats::Photon& photon : test::photons_of(photons))
    if (photon.kind == formats::PathKind::direct) sum += double(photon.flux[0]);
  // 33 333 photons of which a quarter is stored: sigma = sqrt(3 / 33333) = 0.95 %
  EXPECT_NEAR(sum, 4 * M_PI / 6, 4 * 0.0095 * 4 * M_PI / 6);
}

TEST(NormalMap, TiltsAsTheSpecificationSays) {
  // Red towards the image's right, green towards its top. Codes 218 and 128: x = 0.7098, y = 0.0039, z = 0.7098.
  HandMadeScene scene;
  Material material = matte(Rgb(1.0f));
  material.textures.emplace().normal = texture_of_image();
  scene.set_images({png_image(1, 1, 3, {218, 128, 218}), png_image(1, 1, 3, {128, 218, 218})});
  const auto tilted = [&](const std::vector<Vec2>& uvs, bool green, bool flipped = false) {
    material.textures->normal.image = green ? 1 : 0;
    HandMadeScene one;
    one.set_images({png_image(1, 1, 3, {218, 128, 218}), png_image(1, 1, 3, {128, 218, 218})});
    one.add_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, material);
    one.set_uvs(uvs);
    SceneFrame frame = one.frame();
    frame.surfaces[0].flipped = flipped;
    const Tracer tracer(frame);
    Hit hit;
    EXPECT_TRUE(tracer.intersect({{0.6f, 0.3f, 1}, {0, 0, -1}, 0, INFINITY}, hit));
    SurfacePoint point = tracer.surface_point(hit);
    const SurfaceMaterial here(frame, point, 0);
    return point.normal;
  };
  const float s = std::sqrt(0.5f);
  const auto expect = [&](Vec3 normal, Vec3 wanted) {
    EXPECT_GT(dot(normal, wanted), 0.9999f) << normal.x << " " << normal.y << " " << normal.z;
  };
  const std::vector<Vec2> upright{{0, 1}, {1, 1}, {1, 0}, {0, 0}};  // the image's top at y = 1
  expect(tilted(upright, false), {s, 0, s});
  expect(tilted(upright, true), {0, s, s});
  const std::vector<Vec2> mirrored{{1, 1}, {0, 1}, {0, 0}, {1, 0}};  // the image's right at x = 0
  expect(tilted(mirrored, false), {-s, 0, s});
  expect(tilted(mirrored, true), {0, s, s});
  const std::vector<Vec2> turned{{0, 0}, {0, 1}, {1, 1}, {1, 0}};  // the image's right at y = 1, its top at x = 0
  expect(tilted(turned, false), {0, s, s});
  expect(tilted(turned, true), {-s, 0, s});
  expect(tilted(upright, false, true), {s, 0, -s});  // the other side is the front
  const std::vector<Vec2> nowhere(4, Vec2{0.3f, 0.3f});
  expect(tilted(nowhere, false), {0, 0, 1});
}

TEST(NormalMap, ATiltedNormalIsLitLikeATiltedPlane) {
  // Light from straight above on a matte plane whose map tilts normals by 45 degrees: cos 45 of the plain plane's
  // light.
  HandMadeScene scene;
  Material material = matte(Rgb(0.8f));
  material.textures.emplace().normal = texture_of_image();
  scene.set_images({png_image(1, 1, 3, {218, 128, 218})});
  scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, material);
  scene.set_uvs({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  scene.add_point_light({0, 0, 100}, Rgb(1e4f));
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  RayCounts counts;
  const Vec3 eye{0.5f, 0.2f, 1};
  const Layers layers = trace_eye_path({tracer, lights}, {eye, normalize(Vec3{0.01f, 0.02f, 0} - eye), 0, INFINITY},
                                       PixelRandom(1, 7, 0), nullptr, counts);
  EXPECT_NEAR(layers[Layer::direct].g, 0.8 / M_PI * std::sqrt(0.5), 2e-3);
}

/// A plate of side 2 with a normal map of stripes that lean 45 degrees to the left and to the right alternately;
/// without stripes: plain.
void add_ridges(int stripes, HandMadeScene& scene) {
  Material plate = matte(Rgb(0.5f));
  if (stripes > 0) {
    plate.textures.emplace().normal = texture_of_image();
    plate.textures->normal.nearest = true;
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < stripes * stripes; ++i) texels.insert(texels.end(), {std::uint8_t(i % 2 ? 37 : 218), 128, 218});
    scene.set_images({png_image(stripes, stripes, 3, texels)});
  }
  scene.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, plate);
  scene.set_uvs({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
}

/// Flux of direct photons on such a plate.
double flux_on_ridges(int stripes, Vec3 lamp, std::uint64_t count) {
  HandMadeScene scene;
  add_ridges(stripes, scene);
  scene.add_point_light(lamp, Rgb(1.0f));
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  PhotonOptions options;
  options.photon_count = count;
  double sum = 0;
  for (const formats::Photon& photon : test::photons_of(PhotonTracer(tracer, lights, options)))
    if (photon.kind == formats::PathKind::direct) sum += double(photon.flux[0]);
  return sum;
}

constexpr float kSlanting = 75 * kPi / 180;
/// Cosines of light at 75 degrees to a stripe that leans 45 degrees towards it, and to the plate.
const double kTowards = std::cos(kPi / 6), kLevel = std::cos(kSlanting);

/// A lamp 3 m away at 75 degrees. h and a are its height above a place and its horizontal distance. A stripe that leans
/// towards it gets (a + h) / (h sqrt 2) times the light of the plane, the next one none. 3 800 photons: 1.7 % of noise,
/// most of it the same on both; codes are accurate to 1 %.
TEST(NormalMap, PhotonsOnFineRidgesFollowEachOfThem) {
  const Vec3 lamp{-3 * std::sin(kSlanting), 0, 3 * std::cos(kSlanting)};
  double plain = 0, ridges = 0;
  for (float x = -0.995f; x < 1; x += 0.01f)
    for (float y = -0.995f; y < 1; y += 0.01f) {
      const Vec3 to = lamp - Vec3{x, y, 0};
      const double d = double(length(to));
      plain += double(to.z) / (d * d * d);
      ridges += double(to.z - to.x) * std::sqrt(0.5) / 2 / (d * d * d);
    }
  EXPECT_NEAR(flux_on_ridges(128, lamp, 100'000) / flux_on_ridges(0, lamp, 100'000), ridges / plain,
              0.03 * ridges / plain);
}

/// Two halves that lean 45 degrees inwards, with a lamp 50 m above: cos 45 of the plane's light, plus 1 %, because the
/// lamp is half a metre towards the side to which either half leans.
TEST(NormalMap, PhotonsOnBroadRidgesFollowThem) {
  const double plain = flux_on_ridges(0, {0, 0, 50}, 1'000'000);
  EXPECT_NEAR(flux_on_ridges(2, {0, 0, 50}, 1'000'000), std::sqrt(0.5) * 1.01 * plain, 0.01 * plain);
}

/// Sun of 1 W/m^2 at 75 degrees on a plate of ridges under a thin plate of glass of transmittance T: caustic light.
struct RidgesUnderGlass {
  HandMadeScene made;
  SceneFrame frame;
  Tracer tracer;
  Lights lights;
  formats::PhotonBlock photons;
  explicit RidgesUnderGlass(int stripes)
      : frame(frame_of(made, stripes)), tracer(frame), lights(frame, build_emission_table({&frame, 1})) {
    PhotonOptions options;
    options.photon_count = 400'000;
    options.set_kinds("caustic");
    const PhotonTracer photons_of(tracer, lights, options);
    for (std::size_t batch = 0; batch < photons_of.batch_count(); ++batch) {
      const formats::PhotonBlock some = photons_of.trace(batch).block;
      photons.photons.insert(photons.photons.end(), some.photons.begin(), some.photons.end());
      photons.directions.insert(photons.directions.end(), some.directions.begin(), some.directions.end());
    }
  }
  static SceneFrame frame_of(HandMadeScene& made, int stripes) {
    add_ridges(stripes, made);
    made.add_box({-2, -1.2f, 0.2f}, {1, 1.2f, 0.2001f}, test::glass(0));
    SceneFrame frame = made.frame();
    PlacedLight sun;
    sun.light.kind = PunctualLight::Kind::directional;
    sun.light.intensity = Rgb(1.0f);
    sun.direction = {std::sin(kSlanting), 0, -std::cos(kSlanting)};
    frame.lights.push_back(sun);
    return frame;
  }
  /// (1 - F) / (1 + F): both faces, with all reflections between them.
  static double transmittance() {
    const double mu = std::cos(kSlanting), c = std::sqrt(1 - (1 - mu * mu) / 2.25);
    const double rs = (mu - 1.5 * c) / (mu + 1.5 * c), rp = (1.5 * mu - c) / (1.5 * mu + c),
                 f = (rs * rs + rp * rp) / 2;
    return (1 - f) / (1 + f);
  }
  /// Mean caustic irradiance E = pi / rho times the radiance of 400 rays from just above, each with a footprint of
  /// `width`.
  double seen(float width) const {
    PhotonLightOptions options;
    options.caustic_only = true;
    const PhotonLight light(tracer, photons, {}, options);
    KnownLight known;
    known.photons = &light;
    RayCounts counts;
    double sum = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
      const Vec3 eye{-0.6f + 1.2f * radical(i, 2), -0.6f + 1.2f * radical(i, 3), 0.1f};
      sum += double(trace_eye_path({tracer, lights}, {eye, {0, 0, -1}, 0, INFINITY}, PixelRandom(1, 7, i), &known,
                                   counts, {width, 0})[Layer::caustic]
                        .g);
    }
    return sum / 400 * kPi / 0.5;
  }
  static float radical(std::uint32_t i, std::uint32_t base) {
    float value = 0, digit = 1.0f / float(base);
    for (; i > 0; i /= base, digit /= float(base)) value += float(i % base) * digit;
    return value;
  }
};

/// A camera that resolves the stripes sees T cos 30 on every other one and nothing in between. A camera that does not
/// sees the plate, T cos 75, as in path tracing: 1.67 times less. 16 000 photons: 1 % of noise. In the finer view,
/// which of 400 rays meets which stripe adds 7 % of the mean. Codes are half a code off, 0.0055 of the normal, which is
/// 2.1 % of cos 75.
TEST(NormalMap, CausticLightOnRidgesIsSeenAsTheEyeTellsThemApart) {
  const RidgesUnderGlass ridges(128), plain(0);
  const double arriving = RidgesUnderGlass::transmittance();
  EXPECT_TRUE(plain.photons.directions.empty());
  EXPECT_NEAR(plain.seen(0), arriving * kLevel, 0.03 * arriving * kLevel);
  EXPECT_NEAR(ridges.seen(1), arriving * kLevel, 0.05 * arriving * kLevel);
  EXPECT_NEAR(ridges.seen(0), arriving * kTowards / 2, 0.15 * arriving * kTowards / 2);
}

/// Points represent hits of gather rays: each has the light of the stripe on which it lies.
TEST(NormalMap, PointsOnRidgesGetCausticLightOfTheirStripes) {
  const RidgesUnderGlass ridges(128);
  PointOptions options;
  options.count = 4000;
  std::vector<IrradiancePoint> points = place_points(ridges.frame, options).points;
  estimate_points(ridges.tracer, ridges.lights, ridges.photons, {}, options, points);
  double sum = 0;
  int count = 0, dark = 0;
  for (const IrradiancePoint& point : points) {
    if (point.normal.z < 0 || std::abs(point.position.x) > 0.6f || std::abs(point.position.y) > 0.6f) continue;
    sum += double(point.caustic.g);
    ++count;
    dark += point.caustic.g == 0;
  }
  ASSERT_GT(count, 300);
  const double towards = RidgesUnderGlass::transmittance() * kTowards;
  EXPECT_NEAR(double(dark) / count, 0.5, 0.1);
  EXPECT_NEAR(sum / (count - dark), towards, 0.05 * towards);
}

TEST(Unlit, ShowsItselfToTheEyeAndLightsNothing) {
  HandMadeScene scene;
  Material unlit = matte(Rgb(0.25f, 0.5f, 1.0f));
  unlit.unlit = true;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, unlit);
  scene.add_quad({-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}, matte(Rgb(0.8f)));
  scene.add_point_light({0, 0, 0.5f}, Rgb(1.0f));
  const Tracer tracer(scene.frame());
  const EmissionTable table = table_of(scene);
  EXPECT_TRUE(table.surfaces.empty());
  const Lights lights(scene.frame(), table);
  RayCounts counts;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const Layers wall = trace_eye_path({tracer, lights}, {{0, 0, 0.2f}, normalize(Vec3{1, 0.3f, 0.4f}), 0, INFINITY},
                                       PixelRandom(1, 7, i), nullptr, counts);
    EXPECT_EQ(wall[Layer::emission], (Rgb{0.25f, 0.5f, 1.0f}));
    EXPECT_EQ(wall[Layer::direct], Rgb(0.0f));
    const Layers table_top =
        trace_eye_path({tracer, lights}, {{0, 0, 0.2f}, normalize(Vec3{0.1f, 0.1f, -1}), 0, INFINITY},
                       PixelRandom(1, 7, i), nullptr, counts);
    EXPECT_EQ(table_top[Layer::emission], Rgb(0.0f));
    EXPECT_GT(table_top[Layer::direct].g, 0);
    EXPECT_EQ(table_top[Layer::indirect], Rgb(0.0f));
  }
  PhotonOptions options;
  options.photon_count = 1000;
  const PhotonTracer photons(tracer, lights, options);
  for (const formats::Photon& photon : test::photons_of(photons)) {
    EXPECT_EQ(photon.object, 1);
    EXPECT_EQ(photon.kind, formats::PathKind::direct);
  }
}

/// In a hollow sphere of matte walls every place sends the same light to every other. After one reflection light is
/// uniform, so only the mean reflectance m counts: indirect irradiance is E_0 m / (1 - m) everywhere, where E_0 = F / S
/// is the light of a lamp at the centre. One half of the wall reflects 0.8, the other 0.2.
HandMadeScene two_coloured_sphere() {
  HandMadeScene scene;
  Material wall = matte(Rgb(1.0f));
  wall.textures.emplace().base_color = texture_of_image();
  scene.set_images({png_image(2, 1, 3, {231, 231, 231, 124, 124, 124})});
  scene.add_hollow_sphere({}, 1, 12, wall);
  std::vector<Vec2> uvs;
  // Vertices of a triangle that touch x = 0 lie at x = 0, where u = 0.5 would read the other half.
  for (const Vec3 p : scene.last_positions()) uvs.push_back({0.5f + 0.49f * p.x, 0.5f});
  scene.set_uvs(uvs);
  scene.add_point_light({}, Rgb(1.0f));
  return scene;
}
const double kMeanReflectance =
    (std::pow((231 / 255.0 + 0.055) / 1.055, 2.4) + std::pow((124 / 255.0 + 0.055) / 1.055, 2.4)) / 2;

TEST(TexturedReflectance, PhotonsInASphere) {
  HandMadeScene scene = two_coloured_sphere();
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  PhotonOptions options;
  options.photon_count = 100'000;
  const PhotonTracer photons(tracer, lights, options);
  double sum = 0;
  for (const formats::Photon& photon : test::photons_of(photons))
    if (photon.kind == formats::PathKind::indirect) sum += double(photon.flux[0]);
  // Path lengths are geometric with mean 1: sigma about 1.5 / sqrt(100 000) = 0.5 %
  const double expected = 4 * M_PI * kMeanReflectance / (1 - kMeanReflectance);
  EXPECT_NEAR(sum, expected, 4 * 0.005 * expected);
}

TEST(TexturedReflectance, EyePathsInASphere) {
  HandMadeScene scene = two_coloured_sphere();
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  const double wall = 2 * kMeanReflectance, dark = std::pow((124 / 255.0 + 0.055) / 1.055, 2.4), bright = wall - dark;
  const double irradiance = 1.0;  // I / r^2
  RayCounts counts;
  for (const float side : {-1.0f, 1.0f}) {
    const double rho = side < 0 ? bright : dark;
    double direct = 0, indirect = 0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
      const Ray ray{{0.1f, 0.05f, 0.02f}, normalize(Vec3{side, 0.3f * float(i % 97) / 97, 0.2f}), 0, INFINITY};
      const Layers layers = trace_eye_path({tracer, lights}, ray, PixelRandom(3, 5, std::uint32_t(i)), nullptr, counts);
      direct += double(layers[Layer::direct].g) / kSamples;
      indirect += double(layers[Layer::indirect].g) / kSamples;
    }
    // The faces lie up to 1 % inside the unit sphere, where light is up to 2 % brighter; indirect light has a sigma of
    // about its mean / sqrt(N) = 0.7 %.
    EXPECT_NEAR(direct, rho / M_PI * irradiance, 0.02 * rho / M_PI);
    const double expected = rho / M_PI * irradiance * kMeanReflectance / (1 - kMeanReflectance);
    EXPECT_NEAR(indirect, expected, 0.035 * expected) << side;
  }
}

/// A closed room of side 2 with one reflectance, from an atlas: each face shows the middle quarter of an image of 128
/// texels, 32 per metre. Two texels around the quarter are equal to it; all others are black and must not affect any
/// light. Cones of a tenth, which would mix in these texels, would lose 2 % at each reflection, 8 % in all.
HandMadeScene room_of_charts(float emission) {
  HandMadeScene scene;
  Material wall = matte(Rgb(1.0f), Rgb(emission));
  wall.textures.emplace().base_color = texture_of_image(0, false);
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) texels.push_back(x >= 30 && x < 98 && y >= 30 && y < 98 ? 231 : 0);
  scene.set_images({png_image(128, 128, 1, texels)});
  std::vector<Vec3> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec2> uvs;
  for (const float side : {-1.0f, 1.0f})
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto first = std::uint32_t(corners.size());
      for (const Vec2 at : {Vec2{-1, -1}, Vec2{side, -side}, Vec2{1, 1}, Vec2{-side, side}}) {  // fronts inwards
        Vec3 p{side, side, side};
        p[int(axis + 1) % 3] = at.x;
        p[int(axis + 2) % 3] = at.y;
        corners.push_back(p);
        uvs.push_back({0.5f + 0.25f * at.x, 0.5f + 0.25f * at.y});
      }
      triangles.push_back({first, first + 2, first + 1});
      triangles.push_back({first, first + 3, first + 2});
    }
  scene.add(corners, triangles, wall);
  scene.set_uvs(uvs);
  return scene;
}
const double kChart = std::pow((231 / 255.0 + 0.055) / 1.055, 2.4);

TEST(TexturedReflectance, PhotonsSeeNothingBesideAChart) {
  HandMadeScene scene = room_of_charts(0);
  scene.add_point_light({0.2f, 0.1f, 0.3f}, Rgb(1.0f));
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  PhotonOptions options;
  options.photon_count = 100'000;
  const PhotonTracer photons(tracer, lights, options);
  double sum = 0;
  for (const formats::Photon& photon : test::photons_of(photons))
    if (photon.kind == formats::PathKind::indirect) sum += double(photon.flux[0]);
  // The number of reflections is geometric: sigma = 1 / sqrt(rho N) = 0.35 %
  const double expected = 4 * M_PI * kChart / (1 - kChart);
  EXPECT_NEAR(sum, expected, 4 * 0.0035 * expected);
}

TEST(TexturedReflectance, EyePathsSeeNothingBesideAChart) {
  HandMadeScene scene = room_of_charts(1);
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  RayCounts counts;
  double sum = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const Ray ray{{0.1f, 0.05f, 0.02f}, normalize(Vec3{1, 0.3f * float(i % 97) / 97, 0.2f}), 0, INFINITY};
    const Layers layers = trace_eye_path({tracer, lights}, ray, PixelRandom(3, 5, std::uint32_t(i)), nullptr, counts);
    for (const Layer layer : {Layer::emission, Layer::direct, Layer::indirect})
      sum += double(layers[layer].g) / kSamples;
  }
  // A furnace: 1 / (1 - rho) everywhere. As above, sigma = 1 / sqrt(rho N) = 0.8 %.
  const double expected = 1 / (1 - kChart);
  EXPECT_NEAR(sum, expected, 4 * 0.008 * expected);
}

/// A plate of stripes 0.2 m wide, alternately white metal and black plastic of the same roughness, 20 m below a lamp
/// and the top of a sphere that stores photons. kind: 0 stripes, 1 all metal, 2 all plastic. The light from the stripes
/// is the mean of metal's and plastic's: F0 is 0.52 in the mean; with the mean colour and metalness it would be 0.27.
HandMadeScene striped_plate(int kind) {
  HandMadeScene scene;
  Material plate = matte(Rgb(kind == 2 ? 0.0f : 1.0f));
  plate.metallic = kind == 2 ? 0 : 1;
  plate.roughness = 0.5f;
  plate.specular = 1;
  if (kind == 0) {
    MaterialTextures& textures = plate.textures.emplace();
    textures.base_color = textures.metallic_roughness = texture_of_image();
    std::vector<std::uint8_t> texels;  // green, the roughness, is 1 everywhere
    for (int i = 0; i < 128 * 128; ++i)
      texels.insert(texels.end(), {std::uint8_t(i % 2 * 255), 255, std::uint8_t(i % 2 * 255)});
    scene.set_images({png_image(128, 128, 3, texels)});
  }
  scene.add_quad({-12.8f, -12.8f, 0}, {12.8f, -12.8f, 0}, {12.8f, 12.8f, 0}, {-12.8f, 12.8f, 0}, plate);
  if (kind == 0) scene.set_uvs({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  scene.add_hollow_sphere({0, 0, 0}, 25, 12, matte(Rgb(0.5f)));
  scene.add_point_light({0, 0, 20}, Rgb(100.0f));
  return scene;
}

/// Means for the three kinds; sigma is the standard error of the difference between the first and the mean of the
/// others, as a share of that mean.
struct Stripes {
  double mean[3] = {}, square[3] = {};
  void add(int kind, double value, double count) {
    mean[kind] += value / count, square[kind] += value * value / count / count;
  }
  double expected() const { return (mean[1] + mean[2]) / 2; }
  double sigma() const { return std::sqrt(square[0] + (square[1] + square[2]) / 4); }
};

TEST(TexturedGloss, PhotonsFromAfarMeetWhatIsThere) {
  Stripes flux;
  for (int kind = 0; kind < 3; ++kind) {
    HandMadeScene scene = striped_plate(kind);
    const Tracer tracer(scene.frame());
    const Lights lights(scene.frame(), table_of(scene));
    PhotonOptions options;
    options.photon_count = 200'000;
    const PhotonTracer photons(tracer, lights, options);
    for (const formats::Photon& photon : test::photons_of(photons))
      if (photon.kind == formats::PathKind::caustic) flux.add(kind, double(photon.flux[0]), 1);
  }
  EXPECT_NEAR(flux.mean[0], flux.expected(), 4 * flux.sigma());
  EXPECT_LT(4 * flux.sigma(), 0.1 * flux.expected());  // otherwise the test could not distinguish the two
}

TEST(TexturedGloss, EyePathsFromAfarMeetWhatIsThere) {
  Stripes caustic;
  RayCounts counts;
  for (int kind = 0; kind < 3; ++kind) {
    HandMadeScene scene = striped_plate(kind);
    const Tracer tracer(scene.frame());
    const Lights lights(scene.frame(), table_of(scene));
    constexpr int kSamples = 100'000;
    for (int i = 0; i < kSamples; ++i) {
      const Ray ray{{0.1f, 0.05f, 10}, normalize(Vec3{1, 0.3f * float(i % 97) / 97, 1}), 0, INFINITY};
      const Layers layers = trace_eye_path({tracer, lights}, ray, PixelRandom(3, 5, std::uint32_t(i)), nullptr, counts);
      caustic.add(kind, double(layers[Layer::caustic].r), kSamples);
    }
  }
  EXPECT_NEAR(caustic.mean[0], caustic.expected(), 4 * caustic.sigma());
  EXPECT_LT(4 * caustic.sigma(), 0.1 * caustic.expected());
}

TEST(TexturedReflectance, WhatNoRayMeetsIsNeverDecoded) {
  HandMadeScene scene = two_coloured_sphere();
  const Tracer tracer(scene.frame());
  const Lights lights(scene.frame(), table_of(scene));
  EXPECT_EQ(scene.frame().images->decoded_count(), 0u);
  PhotonOptions options;
  options.photon_count = 10;
  PhotonTracer(tracer, lights, options).trace(0);
  EXPECT_EQ(scene.frame().images->decoded_count(), 1u);
}

}  // namespace
}  // namespace tempolux
