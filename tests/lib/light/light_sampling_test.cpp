// Light sampling: irradiance against closed forms, densities against the samples they belong to.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/light/light_tree.h"
#include "lib/light/spherical_triangle.h"
#include "lib/light/triangle_light.h"
#include "tests/lib/light/light_scene.h"
#include "tests/support/sphere.h"

namespace tempolux {
namespace {

constexpr Vec3 kUp{0, 0, 1};

/// Irradiance at the point by `count` samples. `relative_error` receives sigma of the mean for random numbers; Sobol
/// points have less.
Rgbd irradiance(const Lights& lights, Vec3 point, Vec3 normal, int count, double* sigma = nullptr) {
  Rgbd sum;
  double squares = 0;
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) {
    LightSample s;
    if (!lights.sample(point, normal, sobol_owen_1d(i, 3), sobol_owen_2d(i, 5), s)) continue;
    EXPECT_TRUE(is_finite(s.wi) && is_finite(s.facing_irradiance) && is_finite(s.position));
    EXPECT_NEAR(length(s.wi), 1, 1e-5);
    const double cos = std::max(0.0f, dot(normal, s.wi));
    sum += Rgbd(s.facing_irradiance) * cos;
    squares += s.facing_irradiance.r * cos * (s.facing_irradiance.r * cos);
  }
  const Rgbd mean = sum / double(count);
  if (sigma) *sigma = std::sqrt(std::max(0.0, squares / count - mean.r * mean.r) / count);
  return mean;
}

// Heights and sizes from a lamp far above to a lamp that fills half the sky, and a far lamp that is seen aslant. The
// tolerance is 4 sigma plus the single precision of the positions. Seen to fail: the cosine at the lamp left out of the
// density by area.
TEST(AreaLight, GivesLambertsIrradianceAtAnyDistance) {
  struct Lamp {
    float height, half, aside = 0.1f;
  };
  for (const auto& [height, half, aside] :
       {Lamp{100, 0.5f}, {5, 0.5f}, {1, 0.5f}, {0.2f, 0.5f}, {0.01f, 0.5f}, {2, 30}, {100, 0.5f, 80}}) {
    LightScene scene;
    const auto corners = square_facing_down({aside, 0.2f, height}, half);
    scene.add(corners, Rgb(1, 2, 3));
    const Lights lights = scene.lights();
    double sigma = 0;
    const Rgbd e = irradiance(lights, {0, 0, 0}, kUp, 1 << 14, &sigma);
    const double exact = polygon_irradiance({0, 0, 0}, kUp, corners);
    EXPECT_NEAR(e.r, exact, 4 * sigma + 1e-5 * exact) << height;
    EXPECT_NEAR(e.g, 2 * exact, 8 * sigma + 2e-5 * exact);
    EXPECT_NEAR(e.b, 3 * exact, 12 * sigma + 3e-5 * exact);
  }
}

// A tilted triangle, from where it is sampled by area and by solid angle; and through the two-sided back.
TEST(AreaLight, OfOneTriangleAgreesWithLambertOnBothSides) {
  const std::vector<Vec3> corners{{-0.3f, -0.4f, 1.2f}, {0.2f, 0.9f, 0.8f}, {0.7f, -0.2f, 1.0f}};
  LightScene scene;
  scene.add(corners, Rgb(1.0f), true);
  const Lights lights = scene.lights();
  for (const Vec3 point : {Vec3{0, 0, 0}, Vec3{0.2f, 0, 0.6f}, Vec3{6, 5, -9}}) {
    double sigma = 0;
    const Rgbd e = irradiance(lights, point, kUp, 1 << 14, &sigma);
    const double exact = polygon_irradiance(point, kUp, corners);
    EXPECT_NEAR(e.r, exact, 4 * sigma + 1e-5 * exact);
  }
  const Vec3 above{0.1f, 0.1f, 2.5f};
  EXPECT_NEAR(irradiance(lights, above, -kUp, 1 << 14).r, polygon_irradiance(above, -kUp, corners), 2e-3);
}

/// A two-sided box lamp of half a side `half` around the centre, corners by their bits x, y, z. `open`: without its
/// top.
LightScene box_lamp(Vec3 centre, float half, bool inside_out = false, bool open = false) {
  LightScene scene;
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(centre + Vec3{i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
  scene.add(corners, Rgb(1.0f), true, inside_out);
  auto& triangles = scene.primitives.back().triangles;
  triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {1, 3, 7}, {1, 7, 5},
               {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}, {4, 5, 7}, {4, 7, 6}};
  if (open) triangles.resize(10);
  else triangles.push_back({0, 0, 1});  // without area, as at the poles of spheres
  return scene;
}

/// A drum of 4 x `sides` triangles of radiance 1 around the centre, radius .2, half a height of .1, closed.
std::vector<std::vector<Vec3>> drum(Vec3 centre, int sides) {
  const auto corner = [&](int i, float z) {
    const float phi = 2 * kPi * float(i) / float(sides);
    return centre + Vec3{0.2f * std::cos(phi), 0.2f * std::sin(phi), z};
  };
  std::vector<std::vector<Vec3>> triangles;
  for (int i = 0; i < sides; ++i) {
    const Vec3 a = corner(i, -0.1f), b = corner(i + 1, -0.1f), c = corner(i + 1, 0.1f), d = corner(i, 0.1f);
    const Vec3 below = centre - kUp * 0.1f, above = centre + kUp * 0.1f;
    triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}, {below, b, a}, {above, d, c}});
  }
  return triangles;
}

// Nothing hides a drum, so a sample would have no noise if triangles were chosen by their irradiance. By the upper
// bounds of their irradiance it has a deviation of up to .6.
TEST(LightTree, ChoosesTrianglesOfALampByTheirIrradiance) {
  LightScene scene;
  for (const auto& triangle : drum({0, 0, 2}, 20)) scene.add(triangle, Rgb(1.0f));
  const Lights lights = scene.lights();
  for (const auto& [point, normal] : {std::pair{Vec3{1.3f, 0.4f, 0}, kUp},
                                      {Vec3{0.3f, 0.1f, 0}, kUp},
                                      {Vec3{0.5f, 1.8f, 1}, Vec3{0, -1, 0}},
                                      {Vec3{-1, 1, 2.6f}, -kUp}}) {
    double sigma = 0;
    const double e = irradiance(lights, point, normal, 1 << 14, &sigma).r;
    EXPECT_LT(sigma * (1 << 7) / e, 0.3) << point.x;
  }
}

/// Share of the samples at the origin that lie above z.
double share_above(const Lights& lights, float z) {
  constexpr std::uint32_t kCount = 4096;
  int above = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    LightSample s;
    if (lights.sample({0, 0, 0}, kUp, sobol_owen_1d(i, 3), sobol_owen_2d(i, 5), s)) above += s.position.z > z;
  }
  return above / double(kCount);
}

// The top's back is half of the visible area if the lamp is open. A closed lamp hides it.
TEST(ClosedLamp, BacksAreNotSampledFromOutside) {
  const Vec3 centre{0, 0, 1};
  constexpr float kTop = 1.019995f;
  const LightScene closed = box_lamp(centre, 0.02f);
  EXPECT_EQ(share_above(closed.lights(), kTop), 0);
  EXPECT_EQ(closed.lights().pdf_solid_angle({0, 0, 0}, kUp, 0, 10, {0.001f, -0.001f, 1.02f}), 0);
  EXPECT_GT(closed.lights().pdf_solid_angle({0, 0, 0}, kUp, 0, 0, {-0.001f, 0.001f, 0.98f}), 0);
  EXPECT_GT(share_above(box_lamp(centre, 0.02f, true).lights(), kTop), 0.3) << "inside out";
  LightScene glass = box_lamp(centre, 0.02f);
  glass.frame.materials[0].transmission = 0.5f;
  EXPECT_GT(share_above(glass.lights(), kTop), 0.3) << "glass";
  LightScene open = box_lamp(centre, 0.02f, false, true);
  double sides = 0, sigma = 0;
  for (const auto& c : open.primitives.back().triangles) {
    const auto& p = open.primitives.back().positions;
    sides += polygon_irradiance({0, 0, 0}, kUp, {p[c[0]], p[c[1]], p[c[2]]});
  }
  const double e = irradiance(open.lights(), {0, 0, 0}, kUp, 1 << 14, &sigma).r;
  EXPECT_NEAR(e, sides, 4 * sigma + 1e-5 * sides) << "open";
}

TEST(ClosedLamp, LightsItsInsideToo) {
  const LightScene scene = box_lamp({0, 0, 0}, 1);
  double sigma = 0;
  const double e = irradiance(scene.lights(), {0.3f, 0.1f, -0.5f}, kUp, 1 << 15, &sigma).r;
  EXPECT_NEAR(e, kPi, 4 * sigma + 1e-4);
}

TEST(AreaLight, IsDarkFromBehindAndEdgeOn) {
  LightScene scene;
  scene.add(square_facing_down({0, 0, 1}, 0.5f), Rgb(1.0f));
  const Lights lights = scene.lights();
  EXPECT_EQ(irradiance(lights, {0, 0, 2}, -kUp, 64).r, 0);
  EXPECT_EQ(irradiance(lights, {3, 0, 1}, {-1, 0, 0}, 64).r, 0);
  EXPECT_EQ(lights.pdf_solid_angle({0, 0, 2}, {}, 0, 0, {0, 0, 1}), 0);
  // Almost edge-on: E = L A cos cos / d^2, with cos of the light 1e-3 / 3.
  const Vec3 point{3, 0, 1 - 1e-3f};
  EXPECT_NEAR(irradiance(lights, point, {-1, 0, 0}, 1 << 14).r,
              polygon_irradiance(point, {-1, 0, 0}, square_facing_down({0, 0, 1}, 0.5f)), 2e-6);
}

TEST(AreaLight, MirroredSurfacesShineFromTheOtherWinding) {
  LightScene scene;
  scene.add(square_facing_down({0, 0, 1}, 0.5f), Rgb(1.0f), false, true);
  const Lights lights = scene.lights();
  EXPECT_EQ(irradiance(lights, {0, 0, 0}, kUp, 64).r, 0);
  EXPECT_GT(irradiance(lights, {0, 0, 2}, -kUp, 64).r, 0.1);
}

// A needle that fills 0.1 sr, for which single precision could lose the sampled direction.
TEST(AreaLight, NeedlesAreSampledUniformly) {
  const std::vector<Vec3> corners{{-20, -0.05f, 1}, {-20, 0.05f, 1}, {20, 0, 1}};
  LightScene scene;
  scene.add(corners, Rgb(1.0f), true);
  double sigma = 0;
  const Rgbd e = irradiance(scene.lights(), {0, 0.3f, 0}, kUp, 1 << 15, &sigma);
  const double exact = polygon_irradiance({0, 0.3f, 0}, kUp, corners);
  EXPECT_NEAR(e.r, exact, 4 * sigma + 1e-4 * exact);
}

// Without a normal the density is one over the solid angle; an octant of the sphere has pi / 2.
TEST(TriangleLight, HasTheSolidAngleOfAnOctant) {
  LightScene scene;
  scene.add({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, Rgb(1.0f), true);
  const TriangleLight t(scene.frame.surfaces[0], 0, scene.frame.materials[0]);
  Vec3d mean;
  for (std::uint32_t i = 0; i < 1 << 14; ++i) {
    TrianglePoint p;
    ASSERT_TRUE(t.sample({0, 0, 0}, sobol_owen_2d(i, 1), p));
    EXPECT_NEAR(p.pdf_solid_angle, 2 / std::numbers::pi, 1e-6);
    mean += Vec3d(p.wi) / double(1 << 14);
  }
  // Centroid of the octant: each component is 1/2.
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(mean[i], 0.5, 2e-3);
}

TEST(PunctualLights, FollowTheInverseSquareAndTheCosine) {
  LightScene scene;
  scene.add(PunctualLight::Kind::point, {8, 4, 2}, {0, 3, 4}, {0, 0, -1});
  const Rgbd e = irradiance(scene.lights(), {0, 0, 0}, kUp, 4);
  EXPECT_NEAR(e.r, 8.0 / 25 * 0.8, 1e-6);
  EXPECT_NEAR(e.b, 2.0 / 25 * 0.8, 1e-6);
}

// Inner cone 0.2, outer 0.4 rad: full, falling as ((cos t - cos o) / (cos i - cos o))^2, nothing.
TEST(PunctualLights, SpotsFallOffAsGltfSays) {
  LightScene scene;
  scene.add(PunctualLight::Kind::spot, Rgb(10.0f), {0, 0, 2}, {0, 0, -1}, 0.2f, 0.4f);
  const Lights lights = scene.lights();
  for (float angle : {0.0f, 0.19f, 0.25f, 0.3f, 0.39f, 0.41f, 1.0f}) {
    const double s = std::clamp((std::cos(angle) - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4)), 0.0, 1.0);
    const double d2 = 4 / (std::cos(angle) * std::cos(angle));
    EXPECT_NEAR(irradiance(lights, {2 * std::tan(angle), 0, 0}, kUp, 4).r, 10 * s * s / d2 * std::cos(angle), 2e-5);
  }
}

TEST(PunctualLights, DirectionalLightComesFromBeyondTheScene) {
  LightScene scene(5);
  scene.add(PunctualLight::Kind::directional, Rgb(3.0f), {0, 0, 0}, normalize(Vec3{1, 0, -1}));
  const Lights lights = scene.lights();
  EXPECT_NEAR(irradiance(lights, {1, 2, 3}, kUp, 4).r, 3 * std::sqrt(0.5), 1e-6);
  LightSample s;
  ASSERT_TRUE(lights.sample({5, 5, 5}, kUp, 0.3f, {}, s));
  EXPECT_TRUE(s.only_sampled);
  EXPECT_GT(length(s.position), std::sqrt(75.0f));
  EXPECT_FALSE(lights.sample({0, 0, 0}, -kUp, 0.3f, {}, s));
}

TEST(PunctualLights, ArePointsWithoutNaN) {
  LightScene scene;
  scene.add(PunctualLight::Kind::point, Rgb(1.0f), {1, 1, 1}, {0, 0, -1});
  LightSample s;
  EXPECT_FALSE(scene.lights().sample({1, 1, 1}, {}, 0.5f, {}, s));
  ASSERT_TRUE(scene.lights().sample({1, 1, 1 + 1e-7f}, {}, 0.5f, {}, s));
  EXPECT_TRUE(is_finite(s.facing_irradiance) && is_finite(s.wi));
}

/// Many lights of all kinds: a sphere of triangles, two-sided flakes, points and spots, and suns if wanted.
LightScene crowd(int count, bool suns) {
  LightScene scene;
  const PathRandom random(9, 1);
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) {
    const Vec3 n = test::sample_sphere(random.get2(i, Purpose::test, 0));
    const Vec2 place = random.get2(i, Purpose::test, 1), size = random.get2(i, Purpose::test, 2);
    const Vec3 at = Vec3{place.x, place.y, size.x} * 6.0f - Vec3{3, 3, 3};
    const Rgb emission = Rgb(0.1f + place.x, 0.2f, size.y);
    if (i % 5 == 3) scene.add(PunctualLight::Kind::point, emission, at, n);
    else if (i % 5 == 4) scene.add(PunctualLight::Kind::spot, emission, at, n, 0.3f, 0.3f + size.x);
    else
      scene.add({at, at + Vec3{0.2f * n.y, 0.3f * n.z, 0.1f}, at + Vec3{0.1f, 0.2f * n.x, -0.3f * n.y}}, emission,
                i % 5 == 2);
  }
  if (suns) {
    scene.add(PunctualLight::Kind::directional, Rgb(0.01f), {}, {0, 0, -1});
    scene.add(PunctualLight::Kind::directional, Rgb(0.02f), {}, {0, 1, 0});
  }
  return scene;
}

// sample() returns the pdf that pdf_solid_angle() has for the returned place: the same decisions from the same
// numbers. The tolerance of 1e-4 is for the rounding of the position. Seen to fail: the choice between distant and
// other lights left out.
TEST(Lights, PdfIsThatOfTheSample) {
  const LightScene scene = crowd(200, true);
  const Lights lights = scene.lights();
  const PathRandom random(2, 2);
  int found = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const Vec3 point =
        (Vec3{random.get1(i, Purpose::place, 0), random.get1(i, Purpose::place, 1), random.get1(i, Purpose::place, 2)} -
         Vec3{0.5f, 0.5f, 0.5f}) *
        8.0f;
    const Vec3 normal = i % 3 ? test::sample_sphere(random.get2(i, Purpose::test)) : Vec3{};
    LightSample s;
    if (!lights.sample(point, normal, random.get1(i, Purpose::light_choice), random.get2(i, Purpose::light_point), s))
      continue;
    if (s.only_sampled) continue;
    // The triangle is the one whose density agrees; there must be one.
    double best = INFINITY;
    for (const EmissionSlot& slot : lights.slots()) {
      if (slot.kind != EmissionSlot::Kind::triangle) continue;
      const TriangleLight t(scene.frame.surfaces[slot.surface], slot.triangle,
                            scene.frame.materials[scene.frame.surfaces[slot.surface].material]);
      if (std::abs(dot(t.normal, s.position - t.corner)) > 1e-4f || length(s.position - t.corner) > 0.6f) continue;
      const double pdf = lights.pdf_solid_angle(point, normal, slot.surface, slot.triangle, s.position);
      best = std::min(best, std::abs(pdf / s.pdf_solid_angle - 1));
    }
    EXPECT_LT(best, 2e-4) << i;
    ++found;
  }
  EXPECT_GT(found, 2000);
}

// E is the integral over all lights, computed light by light. Choosing lights by importance must not lose or double
// any.
TEST(Lights, ManyTogetherGiveTheSumOfEach) {
  const LightScene scene = crowd(60, true);
  const Lights all = scene.lights();
  for (const Vec3 point : {Vec3{0, 0, 0}, Vec3{2, -1, -3.5f}, Vec3{-4, 4, 1}}) {
    const Vec3 normal = normalize(Vec3{0.3f, 0.2f, 0.8f});
    double sum = 0, sigma = 0;
    for (std::size_t i = 0; i < scene.frame.surfaces.size() + scene.frame.lights.size(); ++i) {
      SceneFrame one = scene.frame;
      one.lights.clear();
      for (Material& m : one.materials) m.emission = Rgb(0.0f);
      if (i < one.surfaces.size()) one.materials[i] = scene.frame.materials[i];
      else one.lights.push_back(scene.frame.lights[i - one.surfaces.size()]);
      sum +=
          irradiance(Lights(one, build_emission_table(std::span<const SceneFrame>(&one, 1))), point, normal, 1 << 12).r;
    }
    const Rgbd e = irradiance(all, point, normal, 1 << 18, &sigma);
    EXPECT_NEAR(e.r, sum, 4 * sigma + 1e-3 * sum) << sigma / sum;
  }
}

// The choice probabilities of all lights sum to 1, minus the probability of walks that end at lights which do not
// reach the point; if all lights are two-sided and the point has no normal, every light reaches the point. Each is the
// frequency with which choose() takes the light: u in equal steps of 2^-16 hits each light within 1 step per level.
// Seen to fail: the choices at the upper nodes left out.
TEST(LightTree, ProbabilitiesAreTheFrequenciesAndSumToOne) {
  std::vector<LightBounds> bounds;
  const PathRandom random(4, 4);
  for (std::uint32_t i = 0; i < 300; ++i) {
    LightBounds b;
    const Vec2 place = random.get2(i, Purpose::test, 1);
    const Vec3 at{place.x * 4, place.y * 4, random.get1(i, Purpose::test, 2)};
    b.box.add(at);
    b.box.add(at + Vec3{0.1f, 0.05f, 0.2f});
    b.axis = test::sample_sphere(random.get2(i, Purpose::test, 3));
    b.add_weight(b.axis, 0.01 + double(random.get1(i, Purpose::test, 4)));
    b.two_sided = i % 3 == 0;
    bounds.push_back(b);
  }
  const LightTree tree(bounds);
  for (LightBounds& b : bounds) b.two_sided = true;
  const LightTree two_sided_tree(bounds);
  for (std::uint32_t k = 0; k < 20; ++k) {
    const Vec3 point =
        Vec3{random.get1(k, Purpose::place, 0), random.get1(k, Purpose::place, 1), random.get1(k, Purpose::place, 2)} *
            8.0f -
        Vec3{2, 2, 3};
    const Vec3 normal = k % 2 ? test::sample_sphere(random.get2(k, Purpose::test, 9)) : Vec3{};
    std::vector<double> count(bounds.size(), 0);
    double lost = 0, sum = 0;
    constexpr int kSteps = 1 << 16;
    for (int i = 0; i < kSteps; ++i) {
      LightTree::Choice c;
      if (!tree.choose(tree.start(point, normal), point, normal, (float(i) + 0.5f) / kSteps, c)) {
        ++lost;
        continue;
      }
      ++count[c.light];
      EXPECT_NEAR(c.probability, tree.probability(point, normal, c.light), 1e-12);
    }
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
      const double p = tree.probability(point, normal, i);
      EXPECT_NEAR(count[i] / kSteps, p, 2.0 / kSteps);
      sum += p;
    }
    EXPECT_NEAR(sum + lost / kSteps, 1, 300.0 / kSteps);
    EXPECT_LT(sum, 1 + 1e-9);
    if (normal != Vec3{}) continue;
    double all_reach = 0;
    for (std::uint32_t i = 0; i < bounds.size(); ++i) all_reach += two_sided_tree.probability(point, normal, i);
    EXPECT_NEAR(all_reach, 1, 1e-9);
  }
}

TEST(Lights, SurviveExtremeNumbers) {
  LightScene scene;
  scene.add(square_facing_down({0, 0, 1}, 0.5f), Rgb(1e-20f));
  scene.add(square_facing_down({1, 0, 1}, 0.5f), Rgb(1.0f));
  scene.add(square_facing_down({2, 0, 1}, 0.5f), Rgb(1e20f));
  scene.add(square_facing_down({0, 1, 1}, 5e-7f), Rgb(1.0f));
  scene.add({{0, 0, 1}, {0, 0, 1}, {1, 0, 1}}, Rgb(1.0f));
  scene.add(PunctualLight::Kind::point, Rgb(1e-20f), {0, 0, 0}, {0, 0, -1});
  scene.add(PunctualLight::Kind::spot, Rgb(1e20f), {0, 0, 1}, {0, 0, -1}, 0, 0);
  const Lights lights = scene.lights();
  const PathRandom random(6, 6);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const float scale = std::pow(10.0f, float(i % 12) - 8);
    const Vec3 point = Vec3{0, float(i % 2), 1} + test::sample_sphere(random.get2(i, Purpose::place)) * scale;
    LightSample s;
    if (lights.sample(point, i % 2 ? kUp : Vec3{}, random.get1(i, Purpose::light_choice),
                      random.get2(i, Purpose::light_point), s)) {
      EXPECT_TRUE(is_finite(s.facing_irradiance) && is_finite(s.wi) && is_finite(s.position) &&
                  std::isfinite(s.pdf_solid_angle));
    }
    for (std::uint32_t surface = 0; surface < 5; ++surface)
      EXPECT_TRUE(
          std::isfinite(lights.pdf_solid_angle(point, {}, surface, 0, scene.frame.surfaces[surface].positions[1])));
    const std::array<double, 4> u = {random.get1(i, Purpose::emit, 1), random.get1(i, Purpose::emit, 2),
                                     random.get1(i, Purpose::emit, 3), random.get1(i, Purpose::emit, 4)};
    const PhotonEmission e = lights.emit(u);
    EXPECT_TRUE(is_finite(e.flux) && is_finite(e.origin) && is_finite(e.travel));
  }
}

}  // namespace
}  // namespace tempolux
