// Coverage: closed forms for alpha by factor, texture and vertex colours.
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

}  // namespace
}  // namespace tempolux
