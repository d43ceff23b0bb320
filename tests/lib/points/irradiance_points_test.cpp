// Irradiance points against closed forms: closed boxes, thin walls, boxes on floors, curved meshes.
#include "lib/points/irradiance_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/material/bsdf.h"
#include "tests/support/closed_box.h"
#include "tests/support/photons.h"

namespace tempolux {
namespace {

using test::HandMadeScene;
using test::matte;
using test::Shape;

/// Photons of a uniform light on both sides of every surface, at uniform random places: the flux of each is irradiance
/// 1 x 2 area / count. They are the photons of a furnace, without the noise of its directions.
std::vector<formats::Photon> uniform_photons(const SceneFrame& frame, std::uint32_t count, std::uint64_t seed) {
  const test::AreaSampler area(frame);
  const PathRandom random(seed, 9);
  std::vector<std::uint32_t> object;
  for (const Surface& surface : frame.surfaces)
    object.insert(object.end(), surface.primitive->triangles.size(), surface.object);
  std::vector<formats::Photon> photons;
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec3 p, n;
    area.sample(random.get1(i, Purpose::test), random.get2(i, Purpose::place), p, n);
    if (random.get1(i, Purpose::lobe) < 0.5f) n = -n;
    const float flux = float(2 * area.area() / count);
    photons.push_back({{p.x, p.y, p.z},
                       {flux, flux, flux},
                       formats::encode_normal({n.x, n.y, n.z}),
                       0,
                       formats::PathKind::indirect,
                       1});
  }
  return photons;
}

std::vector<formats::Photon> traced_photons(const Tracer& tracer, const Lights& lights, std::uint64_t count,
                                            std::uint64_t seed) {
  PhotonOptions options;
  options.photon_count = count;
  options.seed = seed;
  options.store_direct = false;
  return test::photons_of(PhotonTracer(tracer, lights, options));
}

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double x) {
    sum += x;
    ++count;
  }
  double value() const { return sum / count; }
};

/// A scene with all objects that an estimate needs.
struct Stage {
  const SceneFrame& frame;
  EmissionTable table;
  Tracer tracer;
  Lights lights;
  explicit Stage(HandMadeScene& scene)
      : frame(scene.frame()), table(build_emission_table({&frame, 1})), tracer(frame), lights(frame, table) {}

  std::vector<IrradiancePoint> estimate(const std::vector<formats::Photon>& photons,
                                        const PointOptions& options) const {
    std::vector<IrradiancePoint> points = place_points(frame, options).points;
    estimate_points(tracer, lights, photons, {}, options, points);
    return points;
  }
};

PointOptions few(std::uint32_t count, std::uint64_t seed) {
  PointOptions options;
  options.count = count;
  options.seed = seed;
  return options;
}

class ClosedBoxPoints : public testing::TestWithParam<std::tuple<Shape, float>> {};

/// The mean of direct + indirect light over the inside is F / (S (1 - rho)). Four seeds of 20k paths leave about n =
/// 20k rho/(1-rho) photons: sigma of the indirect part is 1/sqrt(4 * 20k) sqrt((1+rho)/(rho)) < 1 %; for long paths
/// (rho = 0.99: 100 bounces, lengths vary by 100 %) 0.4 %. Direct light from 4 samples at 4 x 6000 points is exact to
/// 0.2 %. Seen to fail: the photon on the disc's border counted (1.1 %).
TEST_P(ClosedBoxPoints, MeanIrradianceIsTheGeometricSeries) {
  const auto [shape, rho] = GetParam();
  test::ClosedBox box(shape, rho);
  Stage stage(box.scene);
  Mean inside, outside;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const auto photons = traced_photons(stage.tracer, stage.lights, rho > 0.9f ? 4000 : 20000, seed);
    for (const IrradiancePoint& p : stage.estimate(photons, few(6000, seed))) {
      const bool in = dot(p.normal, p.position) < 0;
      (in ? inside : outside).add(double(p.total().g));
    }
  }
  const double expected = double(box.flux.g) / (test::AreaSampler(stage.frame).area() * (1 - double(rho)));
  EXPECT_NEAR(inside.value() / expected, 1, rho > 0.9f ? 0.02 : 0.01);
  EXPECT_EQ(outside.value(), 0);
}

INSTANTIATE_TEST_SUITE_P(Boxes, ClosedBoxPoints,
                         testing::Combine(testing::Values(Shape::cube, Shape::corridor, Shape::sphere),
                                          testing::Values(0.0f, 0.5f, 0.8f, 0.99f)));

/// A path in a closed box of reflectance .8 leaves k photons of indirect light: E k = 4, E k^2 = 36. So the mean over
/// all points has the noise sqrt(36) / (4 sqrt(N)) with N paths, in the signs of paths; with a sign for each photon it
/// would be a third. 24 seeds determine a root of a mean square to 1 / sqrt(2 * 24) = 14 %, so 40 % is 2.8 sigma.
TEST(PointNoise, OfTheMeanOverAllPointsIsThatOfThePaths) {
  test::ClosedBox box(Shape::cube, 0.8f);
  Stage stage(box.scene);
  double square = 0, mean = 0;
  constexpr int kSeeds = 24, kPathsOfSeed = 1000;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Mean noise, indirect;
    for (const IrradiancePoint& p :
         stage.estimate(traced_photons(stage.tracer, stage.lights, kPathsOfSeed, seed), few(1000, 0)))
      if (dot(p.normal, p.position) < 0) noise.add(double(p.noise.g)), indirect.add(double(p.indirect.g));
    square += noise.value() * noise.value() / kSeeds;
    mean += indirect.value() / kSeeds;
  }
  EXPECT_NEAR(std::sqrt(square) / mean / (1.5 / std::sqrt(double(kPathsOfSeed))), 1, 0.4);
}

/// Uniform light in a room: 40k photons on both sides of 24 m^2 and k = 50 give a radius of 0.14 m, a seventh of half a
/// wall, so a third of all discs are cut. An estimate has a sigma of 14 %, and neighbouring estimates share photons.
/// Over 4 seeds, 80k photons on the inside determine the mean to 0.35 %, that of the strip (10 % of a wall) to 1.1 %
/// and that of a wall to 0.9 %. Repeated with every other triangle's front turned outwards.
class RoomPoints : public testing::TestWithParam<bool> {};

/// Seen to fail: the area of the whole disc at edges and corners (6 %).
TEST_P(RoomPoints, NothingIsLostAtEdgesAndCorners) {
  HandMadeScene room, scene;
  room.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
  const Surface& walls = room.frame().surfaces[0];
  std::vector<std::array<std::uint32_t, 3>> triangles = walls.primitive->triangles;
  for (std::size_t t = 0; GetParam() && t < triangles.size(); t += 2) std::swap(triangles[t][1], triangles[t][2]);
  scene.add({walls.positions.begin(), walls.positions.end()}, triangles, matte(Rgb(0.5f)));
  Stage stage(scene);
  Mean all, strip, corner;
  std::map<int, Mean> wall;
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const IrradiancePoint& p : stage.estimate(uniform_photons(stage.frame, 40000, seed), few(5000, seed))) {
      if (dot(p.normal, p.position) > 0) continue;
      const double e = double(p.indirect.g);
      all.add(e);
      for (int a = 0; a < 3; ++a)
        if (std::abs(p.normal[a]) > 0.5f) wall[2 * a + (p.normal[a] > 0)].add(e);
      int near = 0;
      for (int a = 0; a < 3; ++a) near += std::abs(p.normal[a]) < 0.5f && 1 - std::abs(p.position[a]) < 0.1f;
      if (near >= 1) strip.add(e);
      if (near == 2) corner.add(e);
    }
  EXPECT_NEAR(all.value(), 1, 0.012);
  EXPECT_NEAR(strip.value(), 1, 0.02);   // a point on an edge loses half of its disc
  EXPECT_NEAR(corner.value(), 1, 0.05);  // 1 % of the area: 800 photons
  for (const auto& [number, mean] : wall) EXPECT_NEAR(mean.value(), 1, 0.027) << number;
}

INSTANTIATE_TEST_SUITE_P(Windings, RoomPoints, testing::Bool());

/// A wall between a bright and a dark half of a room, as a single sheet and 1 mm thick. The dark side gets no light at
/// all. The bright side loses none, neither on the wall nor on the floor next to it.
class ThinWall : public testing::TestWithParam<float> {};

/// Seen to fail: photons counted from beyond the wall.
TEST_P(ThinWall, DarkSideGetsNothingBrightSideLosesNothing) {
  const float thickness = GetParam();
  HandMadeScene scene;
  scene.add_room({-1, -1, -1}, {1, 1, 1}, matte(Rgb(0.5f)));
  scene.add_quad({0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}, matte(Rgb(0.5f)));
  if (thickness > 0)
    scene.add_quad({-thickness, -1, -1}, {-thickness, 1, -1}, {-thickness, 1, 1}, {-thickness, -1, 1},
                   matte(Rgb(0.5f)));
  Stage stage(scene);
  Mean bright, bright_strip;
  double dark = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    std::vector<formats::Photon> photons = uniform_photons(stage.frame, 60000, seed);
    std::erase_if(photons, [](const formats::Photon& photon) {  // keep photons in the bright half
      const auto n = formats::decode_normal(photon.normal);
      const Vec3 p{photon.position[0], photon.position[1], photon.position[2]};
      const Vec3 just_above = p + Vec3{n[0], n[1], n[2]} * 1e-4f;
      return !(just_above.x > 0 && max_component(abs(just_above)) < 1);
    });
    for (const IrradiancePoint& p : stage.estimate(photons, few(5000, seed))) {
      const Vec3 above = p.position + p.normal * 1e-4f;
      if (above.x > 0 && max_component(abs(above)) < 1) {
        bright.add(double(p.indirect.g));
        if (p.position.x > 0 && p.position.x < 0.1f && std::abs(p.normal.x) < 0.5f)
          bright_strip.add(double(p.indirect.g));
      } else {
        dark += double(p.indirect.g);
      }
    }
  }
  EXPECT_EQ(dark, 0);
  EXPECT_NEAR(bright.value(), 1, 0.015);       // 4 x 17k photons: 3 sigma
  EXPECT_NEAR(bright_strip.value(), 1, 0.04);  // 5 % of that area
}

INSTANTIATE_TEST_SUITE_P(Thicknesses, ThinWall, testing::Values(0.0f, 0.001f));

/// A closed box on a floor: the floor under the box gets no light, and the floor around it loses none.
TEST(IrradiancePoints, ABoxOnAFloorShadesOnlyWhatItCovers) {
  HandMadeScene scene;
  scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, matte(Rgb(0.5f)));
  scene.add_room({-0.3f, 0, -0.3f}, {0.3f, 0.6f, 0.3f}, matte(Rgb(0.5f)));
  Stage stage(scene);
  Mean around, beside;
  double under = 0, inside = 0;
  const auto covered = [](Vec3 p) { return std::max(std::abs(p.x), std::abs(p.z)) < 0.3f; };
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    std::vector<formats::Photon> photons = uniform_photons(stage.frame, 60000, seed);
    std::erase_if(photons, [&](const formats::Photon& photon) {
      const auto n = formats::decode_normal(photon.normal);
      const Vec3 p{photon.position[0], photon.position[1], photon.position[2]};
      if (p.y < 1e-6f) return n[1] < 0 || covered(p);
      return dot(Vec3{n[0], n[1], n[2]}, p - Vec3{0, 0.3f, 0}) < 0;  // the box is lit from outside
    });
    for (const IrradiancePoint& p : stage.estimate(photons, few(5000, seed))) {
      const double e = double(p.indirect.g);
      if (p.object == 0 && p.normal.y > 0) {
        if (covered(p.position)) under += e;
        else {
          around.add(e);
          if (std::max(std::abs(p.position.x), std::abs(p.position.z)) < 0.4f) beside.add(e);
        }
      } else if (p.object == 1 && dot(p.normal, p.position - Vec3{0, 0.3f, 0}) < 0) {
        inside += e;
      }
    }
  }
  EXPECT_EQ(under, 0);
  EXPECT_EQ(inside, 0);
  EXPECT_NEAR(around.value(), 1, 0.02);  // 4 x 19k photons: 0.4 %; free edges of the floor
  EXPECT_NEAR(beside.value(), 1, 0.04);  // 0.28 of 3.64 m^2: 4 x 1400 photons, 1.3 %
}

/// A lamp in a ceiling that stores no photons (a mirror): discs across its border lose no light.
TEST(IrradiancePoints, WhatStoresNoPhotonsIsNoArea) {
  HandMadeScene scene;
  Material mirror;
  mirror.metallic = 1;
  mirror.roughness = 0;
  for (int x = -2; x < 2; ++x)  // a chequerboard of tiles half a metre wide
    for (int z = -2; z < 2; ++z) {
      const float a = 0.5f * float(x), b = 0.5f * float(z), c = a + 0.5f, d = b + 0.5f;
      scene.add_quad({a, 0, d}, {c, 0, d}, {c, 0, b}, {a, 0, b}, (x + z) % 2 ? mirror : matte(Rgb(0.5f)));
    }
  Stage stage(scene);
  Mean mean;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    std::vector<formats::Photon> photons = uniform_photons(stage.frame, 40000, seed);
    std::erase_if(photons, [](const formats::Photon& p) {
      return (int(std::floor(2 * p.position[0])) + int(std::floor(2 * p.position[2]))) % 2 != 0;
    });
    for (const IrradiancePoint& p : stage.estimate(photons, few(4000, seed))) mean.add(double(p.indirect.g));
  }
  EXPECT_NEAR(mean.value(), 1, 0.015);  // 80k photons; free edges all around
}

/// Spheres of 128 to 968 flat triangles and a torus, inside and outside: uniform light gives uniform estimates. The
/// lowest and highest tenth of the estimates show whether there are rings along the edges of the triangles.
class Curved : public testing::TestWithParam<int> {};

TEST_P(Curved, UniformLightStaysUniform) {
  const int n = GetParam();
  HandMadeScene scene;
  if (n > 0) {
    scene.add_hollow_sphere({}, 1, n, matte(Rgb(0.5f)));
  } else {
    std::vector<Vec3> p;
    std::vector<std::array<std::uint32_t, 3>> t;
    constexpr std::uint32_t kMajor = 24, kMinor = 12;
    for (std::uint32_t i = 0; i < kMajor; ++i)
      for (std::uint32_t j = 0; j < kMinor; ++j) {
        const float a = 2 * kPi * float(i) / float(kMajor), b = 2 * kPi * float(j) / float(kMinor),
                    r = 1 + 0.35f * std::cos(b);
        p.push_back({r * std::cos(a), 0.35f * std::sin(b), r * std::sin(a)});
        const auto at = [&](std::uint32_t x, std::uint32_t y) { return x % kMajor * kMinor + y % kMinor; };
        t.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
        t.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
      }
    scene.add(p, t, matte(Rgb(0.5f)));
  }
  Stage stage(scene);
  Mean in, out;
  Mean bands[2][5];  // from the middles of the triangles to their corners
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const auto photons = uniform_photons(stage.frame, 100000, seed);
    for (const IrradiancePoint& p : stage.estimate(photons, few(4000, seed))) {
      Vec3 middle = p.position;
      if (n == 0) {
        const Vec3 flat{middle.x, 0, middle.z};
        middle = p.position - normalize(flat);
      }
      const bool outside = dot(p.normal, middle) > 0;
      (outside ? out : in).add(double(p.indirect.g));
      // The plane of a triangle is closest to the centre in the middle of the triangle. So the distance from this
      // place within the plane orders places from the middle to the edge.
      const float plane = std::abs(dot(p.position, p.normal)),
                  off = std::sqrt(std::max(0.0f, length2(p.position) - plane * plane));
      if (n > 0) bands[outside][std::min(4, int(off / (0.75f * 1.6f / float(n)) * 5))].add(double(p.indirect.g));
    }
  }
  // 4 x 50k photons per side, 0.23 %, plus the remaining noise of the area.
  EXPECT_NEAR(in.value(), 1, 0.01);
  EXPECT_NEAR(out.value(), 1, 0.01);
  for (int side = 0; side < 2 && n > 0; ++side)
    for (int band = 0; band < 5; ++band)
      if (bands[side][band].count > 1000) { EXPECT_NEAR(bands[side][band].value(), 1, 0.02) << side << " " << band; }
}

INSTANTIATE_TEST_SUITE_P(Meshes, Curved, testing::Values(4, 8, 11, 0));

/// A step 3 cm high in a floor: both levels and the strips on both sides of the step keep their light.
TEST(IrradiancePoints, AStepLosesNothing) {
  HandMadeScene scene;
  const Material material = matte(Rgb(0.5f));
  scene.add(
      {{-1, 0, 1}, {0, 0, 1}, {0, 0, -1}, {-1, 0, -1}, {0, 0.03f, 1}, {0, 0.03f, -1}, {1, 0.03f, 1}, {1, 0.03f, -1}},
      {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}, {4, 6, 7}, {4, 7, 5}}, material);
  Stage stage(scene);
  Mean low, high;
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const IrradiancePoint& p : stage.estimate(uniform_photons(stage.frame, 60000, seed), few(8000, seed))) {
      if (p.normal.y < 0.5f || std::abs(p.position.x) > 0.1f) continue;
      (p.position.x < 0 ? low : high).add(double(p.indirect.g));
    }
  EXPECT_NEAR(low.value(), 1, 0.035);  // 5 % of 120k photons that fall on this side: 6000, 1.3 %
  EXPECT_NEAR(high.value(), 1, 0.035);
}

/// A folded sheet with 60 degrees between its faces. Within 3 cm of a fold a tenth of a disc's light comes from the
/// other face, whose true area is twice its projection onto the point's plane.
TEST(IrradiancePoints, FoldsLoseNothing) {
  HandMadeScene scene;
  constexpr int kFolds = 10;
  constexpr float kWidth = 0.3f;
  std::vector<Vec3> p;
  std::vector<std::array<std::uint32_t, 3>> t;
  for (std::uint32_t i = 0; i <= kFolds; ++i) {
    const Vec3 at{kWidth * float(i), i % 2 ? kWidth / std::sqrt(3.0f) : 0, 0};
    p.push_back(at);
    p.push_back(at + Vec3{0, 0, 3});
    if (i > 0) {
      t.push_back({2 * i - 2, 2 * i - 1, 2 * i + 1});
      t.push_back({2 * i - 2, 2 * i + 1, 2 * i});
    }
  }
  scene.add(p, t, matte(Rgb(0.5f)));
  Stage stage(scene);
  Mean mean;
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const IrradiancePoint& q : stage.estimate(uniform_photons(stage.frame, 60000, seed), few(8000, seed))) {
      const float off = std::abs(q.position.x / kWidth - std::round(q.position.x / kWidth)) * kWidth;
      if (off < 0.03f && q.position.x > kWidth / 2 && q.position.x < kWidth * (kFolds - 0.5f))
        mean.add(double(q.indirect.g));
    }
  EXPECT_NEAR(mean.value(), 1, 0.015);  // a fifth of 240k photons: 0.45 %
}

/// A closed shell as thin as an ear, with photons outside and none inside. No light may leak in, at any angle.
TEST(IrradiancePoints, ThinClosedShapesStayDarkInside) {
  HandMadeScene scene;
  HandMadeScene ball;
  scene.add_hollow_sphere({}, 1, 6, matte(Rgb(0.5f)));
  // Flattened to 4 cm: a lens.
  std::vector<Vec3> p(scene.frame().surfaces[0].positions.begin(), scene.frame().surfaces[0].positions.end());
  for (Vec3& v : p) v.y *= 0.02f;
  ball.add(p, scene.frame().surfaces[0].primitive->triangles, matte(Rgb(0.5f)));
  Stage stage(ball);
  double inside = 0;
  Mean outside;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    std::vector<formats::Photon> photons = uniform_photons(stage.frame, 20000, seed);
    std::erase_if(photons, [](const formats::Photon& photon) {
      return formats::decode_normal(photon.normal)[1] * photon.position[1] < 0;
    });
    for (const IrradiancePoint& q : stage.estimate(photons, few(3000, seed))) {
      if (q.normal.y * q.position.y < 0) inside += double(q.indirect.g);
      else outside.add(double(q.indirect.g));
    }
  }
  EXPECT_EQ(inside, 0);
  EXPECT_NEAR(outside.value(), 1, 0.02);
}

/// Direct light of 1 W/sr at a coated floor at distance d and cosine c: c / d^2 arrival_weight(c), as photons are
/// stored; without a coat c / d^2. Seen to fail: the coat left out (28 %).
TEST(IrradiancePoints, DirectLightCountsByWhatTheCoatLetsIn) {
  Material coated = matte(Rgb(0.5f));
  coated.specular = 1;
  coated.roughness = 0.3f;
  for (const Material& material : {matte(Rgb(0.5f)), coated}) {
    HandMadeScene scene;
    scene.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, material);
    scene.add_point_light({0, 0.1f, 0}, Rgb(1.0f));
    const SceneFrame& frame = scene.frame();
    const EmissionTable table = build_emission_table({&frame, 1});
    const Tracer tracer(frame);
    const Lights lights(frame, table);
    const PointOptions options{.count = 200};
    std::vector<IrradiancePoint> points = place_points(frame, options).points;
    estimate_points(tracer, lights, {}, {}, options, points);
    for (const IrradiancePoint& point : points) {
      if (point.normal.y < 0) continue;
      const float d2 = length2(Vec3{0, 0.1f, 0} - point.position), c = 0.1f / std::sqrt(d2);
      const float expected = c / d2 * Bsdf(material).arrival_weight(Vec3{0, 0, c});
      EXPECT_NEAR(point.direct.g, expected, 1e-4f * expected);
    }
  }
}

/// Direct light is weighted by the shading normal, as photons and camera paths do. The floor's normals lean 30 degrees
/// to the right, and lamps of 1 W/sr are 100 m away (1/10^4 W/m^2 at normal incidence). A lamp at the zenith gives cos
/// 30, one at 30 degrees on the right 1, and one at 65 degrees on the left, behind the normal, 0. Directions change by
/// 0.02 over the floor. Seen to fail: the geometric normal in the cosine (15 %).
TEST(IrradiancePoints, DirectLightCountsByTheShadingNormal) {
  const auto direction = [](float degrees) {
    return Vec3{std::sin(degrees * kPi / 180), std::cos(degrees * kPi / 180), 0};
  };
  for (const auto& [lamp, expected] : {std::pair{0.0f, 0.8660f}, {30.0f, 1.0f}, {-65.0f, 0.0f}}) {
    HandMadeScene scene;
    scene.add({{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}, {{0, 1, 2}, {0, 2, 3}}, matte(Rgb(0.5f)), false,
              std::vector<Vec3>(4, direction(30)));
    scene.add_point_light(direction(lamp) * 100, Rgb(1e4f));
    const SceneFrame& frame = scene.frame();
    const Tracer tracer(frame);
    const Lights lights(frame, build_emission_table({&frame, 1}));
    const PointOptions options{.count = 200};
    std::vector<IrradiancePoint> points = place_points(frame, options).points;
    estimate_points(tracer, lights, {}, {}, options, points);
    for (const IrradiancePoint& point : points) {
      if (point.normal.y > 0) { EXPECT_NEAR(point.direct.g, expected, 0.03f) << "lamp at " << lamp; }
    }
  }
}

TEST(IrradiancePoints, AnyNumberOfThreadsGivesTheSameBytes) {
  test::ClosedBox box(Shape::sphere, 0.8f);
  Stage stage(box.scene);
  const auto photons = traced_photons(stage.tracer, stage.lights, 20000, 1);
  std::vector<IrradiancePoint> expected;
  for (int threads : {1, 2, 3, 7}) {
    const ThreadLimit limit(threads);
    const std::vector<IrradiancePoint> points = stage.estimate(photons, few(3000, 1));
    if (expected.empty()) expected = points;
    ASSERT_EQ(points.size(), expected.size());
    EXPECT_EQ(std::memcmp(points.data(), expected.data(), points.size() * sizeof(points[0])), 0) << threads;
  }
}

/// The number of points per area is equal on all surfaces, up to the rounding up of each surface's number, and equal on
/// both sides.
TEST(IrradiancePoints, AreUniformByArea) {
  HandMadeScene scene;
  scene.add_quad({0, 0, 1}, {3, 0, 1}, {3, 0, 0}, {0, 0, 0}, matte(Rgb(0.5f)));
  scene.add_quad({0, 1, 1}, {1, 1, 1}, {1, 1, 0}, {0, 1, 0}, matte(Rgb(0.5f)));
  scene.add_quad({5, 0, 1e-3f}, {5.001f, 0, 1e-3f}, {5.001f, 0, 0}, {5, 0, 0}, matte(Rgb(0.5f)));
  std::map<std::uint32_t, int> count;
  int up = 0;
  const auto [points, spacing] = place_points(scene.frame(), few(4000, 3));
  for (const IrradiancePoint& p : points) {
    ++count[p.object];
    up += p.normal.y > 0;
  }
  EXPECT_NEAR(count[0], 6000, 2);
  EXPECT_NEAR(count[1], 2000, 2);
  EXPECT_EQ(count[2], 2);  // at least one on each side
  EXPECT_EQ(2 * up, int(points.size()));
  EXPECT_NEAR(spacing, std::sqrt(4.0f / 4000), 1e-5f);
}

}  // namespace
}  // namespace tempolux
