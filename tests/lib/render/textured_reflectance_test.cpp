// Unlit surfaces, and reflectance that varies over a surface: closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/textured_scene.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::png_image;
using test::table_of;
using test::texture_of_image;

/// Red flux [W] of the indirect photons that 100 000 light paths leave.
double indirect_flux(const Tracer& tracer, const Lights& lights) {
  PhotonOptions options;
  options.photon_count = 100'000;
  const PhotonTracer photons(tracer, lights, options);
  double sum = 0;
  for (const formats::Photon& photon : test::photons_of(photons))
    if (photon.kind == formats::PathKind::indirect) sum += double(photon.flux[0]);
  return sum;
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
  const double sum = indirect_flux(tracer, lights);
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
  const double sum = indirect_flux(tracer, lights);
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
