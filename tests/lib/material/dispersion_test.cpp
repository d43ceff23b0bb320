// Dispersion (KHR_materials_dispersion): index by wavelength, the colours of wavelengths, a prism.
#include "lib/material/dispersion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/material/bsdf.h"
#include "lib/material/inside.h"
#include "lib/material/surface_material.h"
#include "tests/support/materials.h"

namespace tempolux {
namespace {

/// Dense flint: V = 36.
Material flint() {
  Material m = test::glass(0, false, 1.62f);
  m.dispersion = 20.0f / 36;
  return m;
}

// Abbe's number is (n_d - 1) / (n_F - n_C), at 587.56, 486.13 and 656.27 nm. Seen to fail: dispersion taken as 1 / V.
TEST(Dispersion, HasTheAbbeNumberOfTheFile) {
  for (float v : {20.0f, 36.0f, 64.0f}) {
    Material m = flint();
    m.dispersion = 20 / v;
    EXPECT_NEAR(index_at(m, 587.56f), m.ior, 1e-5f);
    EXPECT_NEAR((m.ior - 1) / (index_at(m, 486.13f) - index_at(m, 656.27f)) / v, 1, 0.003) << v;
  }
}

// Only solids disperse: neither thin walls, nor opaque surfaces, nor a mirror of index 0, nor a path without
// wavelength.
TEST(Dispersion, IsOfSolidsAlone) {
  Material m = flint();
  EXPECT_TRUE(disperses(m));
  EXPECT_EQ(index_at(m, 0), m.ior);
  Material thin = m, opaque = m, all = m;
  thin.thin_walled = true, opaque.transmission = 0, all.ior = 0;
  EXPECT_FALSE(disperses(thin) || disperses(opaque));
  for (const Material* other : {&thin, &opaque, &all}) EXPECT_EQ(index_at(*other, 450), other->ior);
}

// The mean over u is white within the rounding of 1e5 terms, each channel is at least 0, the channels' sum is 3 within
// the steps of the table, wavelengths ascend. Seen to fail: a table without make_white().
TEST(HeroWavelength, IsWhiteInTheMean) {
  Rgbd sum(0.0);
  float last = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const HeroWavelength hero = hero_wavelength((float(i) + 0.5f) / kCount);
    sum += Rgbd(hero.color) * (1.0 / kCount);
    EXPECT_GE(std::min({hero.color.r, hero.color.g, hero.color.b}), 0);
    EXPECT_NEAR(hero.color.r + hero.color.g + hero.color.b, 3, 0.05);
    EXPECT_GE(hero.nm, last);
    last = hero.nm;
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], 1, 1e-4);
  EXPECT_GT(hero_wavelength(0).nm, 380);
  EXPECT_LT(last, 720);
}

// Red, green and blue wavelengths have the colours of their names.
TEST(HeroWavelength, HasTheColourOfItsWavelength) {
  for (float u = 0.01f; u < 1; u += 0.01f) {
    const HeroWavelength hero = hero_wavelength(u);
    if (hero.nm > 620) { EXPECT_GT(hero.color.r, 2.5f) << hero.nm; }
    if (hero.nm > 515 && hero.nm < 550) { EXPECT_GT(hero.color.g, 2.5f) << hero.nm; }
    if (hero.nm > 445 && hero.nm < 475) { EXPECT_GT(hero.color.b, 2.5f) << hero.nm; }
  }
}

/// The direction in which glass of the scene sends light on from a direction `travel`, at a boundary of normal n that
/// light leaves on the side `out`. Vectors lie in the plane y = 0.
Vec3 refracted(const SceneFrame& frame, Vec3 travel, Vec3 n, bool front, float nm) {
  SurfacePoint point{};
  point.material = 0;
  const SurfaceMaterial material(frame, point, 0, nm);
  const Frame local(front ? n : -n);
  const Bsdf::Sample s = Bsdf(material, front).sample(local.to_local(-travel), 0.999f, {0.5f, 0.5f});
  EXPECT_TRUE(s.transmitted);
  return local.to_world(s.wi);
}

// A prism of 60 degrees, in which light of the d line runs parallel to the base: the deviation is
// a1 - 60 deg + asin(n sin(60 deg - asin(sin a1 / n))), with a1 = asin(n_d / 2). Blue is turned by 4.5 degrees more
// than red. Seen to fail: the d line's index for all wavelengths.
TEST(Dispersion, APrismTurnsEachWavelengthBySnellsLaw) {
  SceneFrame frame;
  frame.materials = {flint()};
  const double top = M_PI / 3, nd = 1.62, a1 = std::asin(nd / 2);
  const auto unit = [](double angle) { return Vec3{float(std::cos(angle)), 0, float(std::sin(angle))}; };
  const Vec3 left = unit(M_PI - top / 2), right = unit(top / 2);  // outward normals of both faces
  const Vec3 in = unit(a1 - top / 2);
  double last = 10;
  for (float nm : {420.0f, 460.0f, 540.0f, 587.56f, 640.0f, 690.0f}) {
    const double v = 36, n = nd + (nd - 1) / v * (523655 / (double(nm) * double(nm)) - 1.5168);
    const double expected = a1 - top + std::asin(n * std::sin(top - std::asin(std::sin(a1) / n)));
    const Vec3 inside = refracted(frame, in, left, true, nm), out = refracted(frame, inside, right, false, nm);
    const double turned = std::acos(double(dot(in, out)));
    EXPECT_NEAR(turned / expected, 1, 0.003) << nm;
    EXPECT_LT(turned, last);
    last = turned;
  }
}

// n^2 of the solids around a photon is that of its wavelength.
TEST(Dispersion, PhotonsInsideHaveTheIndexOfTheirWavelength) {
  const std::vector<Material> materials{flint()};
  Inside inside;
  inside.scatter(0, true, true);
  const float index = index_at(materials[0], 420);
  EXPECT_GT(index, 1.63f);
  EXPECT_NEAR(inside.index_squared(materials, 420), index * index, 1e-6f);
  EXPECT_NEAR(inside.index_squared(materials), 1.62f * 1.62f, 1e-6f);
}

}  // namespace
}  // namespace tempolux
