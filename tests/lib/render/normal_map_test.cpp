// Normal maps: closed forms for tilted normals, ridges, and photons on them.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/points/irradiance_points.h"
#include "tests/support/textured_scene.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::png_image;
using test::table_of;
using test::texture_of_image;

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
    made.add_open_box({-2, -1.2f, 0.2f}, {1, 1.2f, 0.2001f}, test::glass(0));
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

}  // namespace
}  // namespace tempolux
