// Photons through glass: the transmittance of a lens, the absorption of a solid, and agreement with the path tracer.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/photon/photon_trace.h"
#include "tests/support/scenes.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;

Material glass(float roughness, Rgb color = Rgb(1.0f), float distance = INFINITY) {
  Material m;
  m.metallic = 0;
  m.roughness = roughness;
  m.transmission = 1;
  m.ior = 1.5f;
  m.thin_walled = false;
  m.attenuation_color = color;
  m.attenuation_distance = distance;
  return m;
}

struct Stored {
  double direct = 0, caustic = 0, indirect = 0, emitted = 0, gone = 0;  ///< W, green
  std::size_t caustic_count = 0;
  std::uint64_t specular_rays = 0;
};
Stored trace(HandMadeScene& scene, std::uint64_t count, std::uint32_t object) {
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = count;
  const PhotonTracer photons(tracer, lights, options);
  Stored sum;
  for (std::size_t b = 0; b < photons.batch_count(); ++b) {
    const PhotonBatch batch = photons.trace(b);
    for (const formats::Photon& photon : batch.block.photons) {
      if (photon.object != object) continue;
      const double flux = double(photon.flux[1]);
      (photon.kind == formats::PathKind::direct    ? sum.direct
       : photon.kind == formats::PathKind::caustic ? sum.caustic
                                                   : sum.indirect) += flux;
      sum.caustic_count += photon.kind == formats::PathKind::caustic;
    }
    sum.emitted += batch.emitted.g;
    sum.specular_rays += batch.specular_ray_count;
    sum.gone += batch.absorbed.g + batch.escaped.g;
  }
  return sum;
}

/// A black ceiling lamp shines down on a window of glass in a closed frame, above a black floor. The light that arrives
/// is the light that reaches the slab times its transmittance: the integral of T(theta) over the light of a point lamp
/// 1 m above a slab so wide that all light within 60 degrees of straight down meets it.
TEST(Caustics, SlabPassesWhatFresnelSays) {
  for (float color : {1.0f, 0.4f}) {
    HandMadeScene scene;
    scene.add_open_box({-40, -0.1f, -40}, {40, 0.1f, 40}, glass(0, Rgb(color), color < 1 ? 0.2f : INFINITY));
    const std::uint32_t floor =
        scene.add_quad({-400, -2, 400}, {400, -2, 400}, {400, -2, -400}, {-400, -2, -400}, matte(Rgb(0.0f)));
    scene.add_point_light({0, 1.1f, 0}, Rgb(1.0f));
    // Flux 2 pi integral T(mu) dmu over the light downwards that the slab meets: to 40 m, mu from 0.025.
    double expected = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double mu = 0.025 + 0.975 * (i + 0.5) / kSteps, c = std::sqrt(1 - (1 - mu * mu) / 2.25);
      const double rs = (mu - 1.5 * c) / (mu + 1.5 * c), rp = (1.5 * mu - c) / (1.5 * mu + c),
                   f = (rs * rs + rp * rp) / 2;
      const double a = color < 1 ? std::pow(double(color), 0.2 / c / 0.2) : 1;
      expected += 2 * M_PI * (1 - f) * (1 - f) * a / (1 - f * f * a * a) * 0.975 / kSteps;
    }
    const Stored stored = trace(scene, 400000, floor);
    // 200000 photons either arrive or not: .2 % of noise. Light that passes the rim (direct) is not counted. The band
    // is 1 %.
    EXPECT_NEAR(stored.caustic / expected, 1, 0.01) << color;
    EXPECT_EQ(stored.indirect, 0);
    EXPECT_NEAR(stored.gone, stored.emitted, 1e-6 * stored.emitted);
  }
}

/// A lamp 0.3 m above a black floor, both in a slab of glass whose top is 0.2 m above the lamp. All paths see the
/// lamp's radiance undivided: from inside, in the top's mirror image, and from outside. So the floor gets half of the
/// light, and what the top reflects; a black ceiling above the slab gets n^2 times the watts that pass the top. Seen to
/// fail: no factor n^2 at the boundary for light that starts inside.
TEST(Caustics, LampInsideASolidIsAsBrightAsPathsSeeIt) {
  HandMadeScene scene;
  scene.add_box({-40, -1, -40}, {40, 0.2f, 40}, glass(0));
  const std::uint32_t floor =
      scene.add_quad({-39, -0.3f, 39}, {39, -0.3f, 39}, {39, -0.3f, -39}, {-39, -0.3f, -39}, matte(Rgb(0.0f)));
  const std::uint32_t ceiling =
      scene.add_quad({-400, 2, -400}, {400, 2, -400}, {400, 2, 400}, {-400, 2, 400}, matte(Rgb(0.0f)));
  scene.add_point_light({0, 0, 0}, Rgb(1.0f));
  double reflected = 0;  // 2 pi integral F(mu) dmu; total reflection where sin t = 1.5 sin i is above 1
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = (i + 0.5) / kSteps, sin2 = 2.25 * (1 - mu * mu), c = std::sqrt(std::max(0.0, 1 - sin2));
    const double rs = (1.5 * mu - c) / (1.5 * mu + c), rp = (mu - 1.5 * c) / (mu + 1.5 * c);
    reflected += (sin2 >= 1 ? 1 : (rs * rs + rp * rp) / 2) * 2 * M_PI / kSteps;
  }
  // 400000 photons: sigma .2 % of each. The outermost ring, which misses the floor, holds 1.8 % of what is reflected.
  const Stored below = trace(scene, 400000, floor), above = trace(scene, 400000, ceiling);
  EXPECT_NEAR(below.direct / (2 * M_PI), 1, 0.02);
  EXPECT_NEAR(below.caustic / reflected, 1, 0.03);
  EXPECT_NEAR(above.caustic / (2.25 * (2 * M_PI - reflected)), 1, 0.01);
  EXPECT_NEAR(above.gone, above.emitted, 1e-6 * above.emitted);
}

/// A furnace wall and a cube of rough glass: for any roughness, the walls receive the flux that they emit. Walls of
/// area 6 x 16 m^2 emit pi W/m^2 and absorb all light: stored flux = emitted flux.
TEST(Caustics, RoughGlassLosesNoPhotons) {
  for (float roughness : {0.0f, 0.2f, 0.6f, 1.0f}) {
    HandMadeScene closed;
    Material wall = matte(Rgb(0.0f), Rgb(1.0f));
    wall.double_sided = false;
    closed.add_room({-2, -2, -2}, {2, 2, 2}, wall);
    closed.add_box({-1.2f, -1.2f, -1.2f}, {1.2f, 1.2f, 1.2f}, glass(roughness));
    const Stored stored = trace(closed, 200000, 0);
    EXPECT_NEAR((stored.direct + stored.caustic) / stored.emitted, 1, 0.005) << roughness;
    EXPECT_GT(stored.caustic_count, 10000u);
  }
}

/// Flux through a glass ball of radius 1 onto the screen of radius 2.5 at y = -3, by quadrature over the light of a
/// lamp of 1 W/sr at (0, d, 0). All angles inside a sphere are equal: of the incoming light, (1 - F) F^(p-1) (1 - F)
/// leaves after p - 1 internal reflections, and F is reflected outside (p = 0). In its plane the path turns by 2 (i -
/// r), and by pi - 2 r at each reflection.
double ball_onto_screen(double d) {
  constexpr int kSteps = 100000;
  const double least = std::sqrt(1 - 1 / (d * d));  // mu of the grazing ray
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double mu = least + (1 - least) * (k + 0.5) / kSteps, theta = std::acos(mu);
    const double i = std::asin(std::min(1.0, d * std::sin(theta))), r = std::asin(std::sin(i) / 1.5);
    const double ci = std::cos(i), cr = std::cos(r);
    const double rs = (ci - 1.5 * cr) / (ci + 1.5 * cr), rp = (1.5 * ci - cr) / (1.5 * ci + cr),
                 f = (rs * rs + rp * rp) / 2;
    // at: angle from +y of the place where the ray meets the ball; each chord advances it by pi - 2 r.
    for (int p = 0; p < 12; ++p) {
      const double at = (i - theta) + p * (M_PI - 2 * r), x = std::sin(at), y = std::cos(at);
      // The ray leaves at the angle i to the normal, on the side from which it came.
      const double out = at + i, dx = std::sin(out), dy = std::cos(out);
      if (!(dy < 0)) continue;
      const double t = (-3 - y) / dy, where = x + t * dx;
      if (std::abs(where) < 2.5)
        sum += (p == 0 ? f : (1 - f) * (1 - f) * std::pow(f, p - 1)) * 2 * M_PI * (1 - least) / kSteps;
    }
  }
  return sum;
}

/// A lamp 1.5 m from a ball of 32768 triangles: its beam leaves the ball about parallel. 13 % of 400000 photons meet
/// the ball: sigma 0.2 % (inscribed triangles lose 0.02 %); required 1 %.
TEST(Caustics, BallPassesWhatFresnelSays) {
  HandMadeScene scene;
  scene.add_sphere({0, 0, 0}, 1, 64, glass(0), false, false);
  scene.add_quad({-9, -3, 9}, {9, -3, 9}, {9, -3, -9}, {-9, -3, -9}, matte(Rgb(0.0f)));
  scene.add_point_light({0, 1.5f, 0}, Rgb(1.0f));
  const SceneFrame& frame = scene.frame();
  const Tracer tracer(frame);
  const Lights lights(frame, build_emission_table({&frame, 1}));
  PhotonOptions options;
  options.photon_count = 400000;
  const PhotonTracer photons(tracer, lights, options);
  double screen = 0;
  for (std::size_t b = 0; b < photons.batch_count(); ++b)
    for (const formats::Photon& photon : photons.trace(b).block.photons)
      if (photon.kind == formats::PathKind::caustic && std::hypot(photon.position[0], photon.position[2]) < 2.5f)
        screen += double(photon.flux[1]);
  EXPECT_NEAR(screen / ball_onto_screen(1.5), 1, 0.01);
}

/// A mirror whose shading normals n lean 40 degrees towards a lamp 20 degrees above the mirror's plane. The lamp's
/// image below the plane is on the side to which n points, too (ShadingFrame). Cameras see the lamp three ways, and
/// light must go all of them: by n at 80 degrees on the lamp's side; by n and the image at 60 degrees on the other
/// side; and by the upright normal at 20 degrees there, where n faces away from the camera (SeenSide). The flux that a
/// camera sees of 1 W/sr is the radiance times the cosine of the camera's direction to the triangle, so each way sends
/// cos(wo) / d^2 per area. The integral is taken at 100 x 100 places. Of 4 million photons 12000 hit the mirror and a
/// third goes each way: 1.6 %. Seen to fail: without the image `middle` receives nothing.
TEST(Caustics, BentNormalsSendLightAllWaysTheyAreSeenFrom) {
  Material mirror;
  mirror.base_color = Rgb(1.0f);
  mirror.metallic = 1;
  mirror.roughness = 0;
  const float to = 40 * kPi / 180, at = 20 * kPi / 180;
  const Vec3 bent{-std::sin(to), std::cos(to), 0}, lamp{-3 * std::cos(at), 3 * std::sin(at), 0};
  HandMadeScene scene;
  scene.add({{-.5f, 0, .5f}, {.5f, 0, .5f}, {.5f, 0, -.5f}, {-.5f, 0, -.5f}}, {{0, 1, 2}, {0, 2, 3}}, mirror, false,
            std::vector<Vec3>(4, bent));
  const auto above = scene.add_quad({-4, 4, -4}, {1, 4, -4}, {1, 4, 4}, {-4, 4, 4}, matte(Rgb(0.0f)));
  const auto middle = scene.add_quad({1, 4, -4}, {3.4f, 4, -4}, {3.4f, 4, 4}, {1, 4, 4}, matte(Rgb(0.0f)));
  const auto low = scene.add_quad({3.5f, 0.1f, -4}, {3.5f, 0.1f, 4}, {3.5f, 4, 4}, {3.5f, 4, -4}, matte(Rgb(0.0f)));
  scene.add_point_light(lamp, Rgb(1.0f));
  const auto by = [&](Vec3 wi) { return bent * (2 * dot(bent, wi)) - wi; };
  double by_bent = 0, by_image = 0, by_upright = 0;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      const Vec3 there{(float(i) + 0.5f) / 100 - 0.5f, 0, (float(j) + 0.5f) / 100 - 0.5f};
      const float d2 = length2(lamp - there);
      const Vec3 wi = normalize(lamp - there), image{wi.x, -wi.y, wi.z};
      ASSERT_GT(dot(image, bent), 0);
      ASSERT_LT(dot(Vec3{-wi.x, wi.y, -wi.z}, bent), 0);
      by_bent += double(by(wi).y / d2) / 1e4;
      by_image += double(by(image).y / d2) / 1e4;
      by_upright += double(wi.y / d2) / 1e4;
    }
  EXPECT_NEAR(trace(scene, 4'000'000, above).caustic, by_bent, 0.06 * by_bent);
  EXPECT_NEAR(trace(scene, 4'000'000, middle).caustic, by_image, 0.06 * by_image);
  EXPECT_NEAR(trace(scene, 4'000'000, low).caustic, by_upright, 0.06 * by_upright);
}

/// Nothing but matte surfaces: no photon of kind caustic, no ray that an event S sent.
TEST(Caustics, MatteScenesHaveNone) {
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.7f)));
  scene.add_point_light({0, 0, 0}, Rgb(1.0f));
  const Stored stored = trace(scene, 20000, 0);
  EXPECT_EQ(stored.caustic_count, 0u);
  EXPECT_EQ(stored.specular_rays, 0u);
  EXPECT_GT(stored.direct, 0);
}

}  // namespace
}  // namespace tempolux
