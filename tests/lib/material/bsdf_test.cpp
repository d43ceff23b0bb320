// Scattering at a surface: energy, directions, and agreement of samples with the formulas.
#include "lib/material/bsdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "lib/core/random.h"
#include "lib/core/sampling.h"
#include "lib/core/sobol.h"
#include "lib/material/tables/ggx_integrals.h"
#include "tests/support/distribution.h"
#include "tests/support/materials.h"

namespace tempolux {
namespace {

using test::direction;

Material dielectric(Rgb base, float roughness, float specular = 1) {
  Material m;
  m.base_color = base;
  m.metallic = 0;
  m.roughness = roughness;
  m.specular = specular;
  return m;
}
Material metal(Rgb base, float roughness) {
  Material m;
  m.base_color = base;
  m.roughness = roughness;
  return m;
}

/// Albedo towards wo: the mean of the weights of one event over `count` samples.
Rgbd sampled_albedo(const Bsdf& bsdf, Vec3 wo, bool diffuse, int count, double* square = nullptr) {
  Rgbd sum;
  double squares = 0;
  for (int i = 0; i < count; ++i) {
    const Bsdf::Sample s = bsdf.sample(wo, sobol_owen_1d(std::uint32_t(i), 7), sobol_owen_2d(std::uint32_t(i), 11));
    if (s.diffuse != diffuse) continue;
    sum += Rgbd(s.weight);
    squares += double(s.weight.r) * s.weight.r;
  }
  if (square) *square = squares / count;
  return sum / double(count);
}

// The integral of f cos over the hemisphere, in cells of equal cos^2 and phi. The error is O(1/n^2) for the smooth f
// of a roughness of 0.5 and more.
Rgbd integrate(const std::function<Rgb(Vec3)>& f) {
  Rgbd sum;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      sum += Rgbd(f(direction(std::sqrt((float(i) + 0.5f) / n), 2 * kPi * (float(j) + 0.5f) / n)));
  return sum * (std::numbers::pi / (n * n));
}

TEST(Matte, IsLambertToTheBit) {
  const Bsdf bsdf(dielectric({0.2f, 0.5f, 0.8f}, 0.3f, 0));
  EXPECT_TRUE(bsdf.has_diffuse());
  EXPECT_FALSE(bsdf.has_specular());
  for (float c : {1e-6f, 0.1f, 0.7f, 1.0f}) {
    EXPECT_EQ(bsdf.diffuse_coupling(direction(c, 0)), 1.0f);
    EXPECT_EQ(bsdf.arrival_weight(direction(c, 0)), 1.0f);
    EXPECT_EQ(bsdf.diffuse_reflectance(direction(c, 0)), bsdf.diffuse_albedo());
  }
  const Vec3 wi = direction(0.3f, 1), wo = direction(0.8f, 4);
  EXPECT_EQ(bsdf.eval_diffuse(wi, wo), Rgb(0.2f, 0.5f, 0.8f) * kInvPi);
  EXPECT_EQ(bsdf.eval_specular(wi, wo), Rgb(0.0f));
  EXPECT_EQ(bsdf.pdf_diffuse(wi, wo), pdf_hemisphere_cos(0.3f));
  const Bsdf::Sample s = bsdf.sample(wo, 0.999f, {0.3f, 0.6f});
  EXPECT_EQ(s.weight, Rgb(0.2f, 0.5f, 0.8f));
  EXPECT_TRUE(s.diffuse);
  EXPECT_EQ(s.pdf_solid_angle, pdf_hemisphere_cos(s.wi.z));
}

TEST(Bsdf, HasTheFresnelTermOfGltf) {
  // ior 1.5: F0 = 0.04, read off a mirror at normal incidence; metal: the base color.
  EXPECT_NEAR(Bsdf(dielectric(Rgb(0.0f), 0)).sample(Vec3{0, 0, 1}, 0.5f, {}).weight.r, 0.04f, 1e-6);
  EXPECT_NEAR(Bsdf(dielectric(Rgb(0.0f), 0, 0.5f)).sample(Vec3{0, 0, 1}, 0.5f, {}).weight.r, 0.02f, 1e-6);
  const Rgb gold = Bsdf(metal({1, 0.8f, 0.3f}, 0)).sample(Vec3{0, 0, 1}, 0.5f, {}).weight;
  EXPECT_NEAR(gold.g, 0.8f, 1e-6);
  EXPECT_NEAR(gold.b, 0.3f, 1e-6);
  Material ior_zero = dielectric(Rgb(0.5f), 0);
  ior_zero.ior = 0;  // KHR_materials_ior: F = 1
  EXPECT_NEAR(Bsdf(ior_zero).sample(Vec3{0, 0, 1}, 0.5f, {}).weight.r, 1, 1e-6);
  EXPECT_FALSE(Bsdf(ior_zero).has_diffuse());
}

TEST(Mirror, ReflectsTheWholeDirectionAndOnlyThat) {
  const Bsdf bsdf(metal({0.9f, 0.5f, 0.1f}, 0.01f));
  EXPECT_TRUE(bsdf.specular_is_delta());
  const Vec3 wo = direction(0.3f, 2);
  const Bsdf::Sample s = bsdf.sample(wo, 0.7f, {0.1f, 0.2f});
  EXPECT_EQ(s.wi, (Vec3{-wo.x, -wo.y, wo.z}));
  EXPECT_TRUE(s.delta);
  EXPECT_FALSE(s.diffuse);
  const float k = std::pow(0.7f, 5.0f);
  EXPECT_NEAR(s.weight.b, 0.1f + 0.9f * k, 1e-6);
  EXPECT_EQ(bsdf.eval_specular(s.wi, wo), Rgb(0.0f));
  EXPECT_EQ(bsdf.pdf_specular(s.wi, wo), 0);
}

// The Lambert lobe reflects rho (1 - A), to the 1e-4 of the table. For the other lobes the mean of the sample weights
// must equal the integral of f by quadrature. Lobe and direction are independent sequences of 2^16 points, at worst
// as noisy as random numbers: sigma is 0.5 / 256 for weights up to 1, and the band 2 sigma. Seen to fail: event D not
// divided by its probability.
TEST(Bsdf, SamplesWeighWhatTheFormulasIntegrateTo) {
  for (const Material& m :
       {dielectric({0.8f, 0.5f, 0.2f}, 0.6f), metal({0.9f, 0.6f, 0.2f}, 0.8f), dielectric(Rgb(1.0f), 1.0f)}) {
    const Bsdf bsdf(m);
    for (float c : {0.15f, 0.5f, 0.95f}) {
      const Vec3 wo = direction(c, 0.4f);
      const Rgbd d = integrate([&](Vec3 wi) { return bsdf.eval_diffuse(wi, wo); });
      const Rgbd s = integrate([&](Vec3 wi) { return bsdf.eval_specular(wi, wo); });
      const Rgbd d_sampled = sampled_albedo(bsdf, wo, true, 1 << 16);
      const Rgbd s_sampled = sampled_albedo(bsdf, wo, false, 1 << 16);
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(d[i], double(bsdf.diffuse_reflectance(direction(c, 0))[i]), 2e-4) << c;
        EXPECT_NEAR(d_sampled[i], d[i], 4e-3) << c;
        EXPECT_NEAR(s_sampled[i], s[i], 4e-3) << c;
        EXPECT_NEAR(s[i], double(bsdf.specular_albedo(direction(c, 0))[i]), 2e-4) << c;
      }
    }
  }
}

// integral of c cos / pi = sqrt(1 - A_mean), and so arrival_weight averages to 1.
TEST(Bsdf, CouplingAveragesToWhatItsNormalisationSays) {
  for (float roughness : {0.0f, 0.03f, 0.2f, 0.5f, 1.0f}) {
    const Bsdf bsdf(dielectric(Rgb(0.7f), roughness));
    double sum = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) sum += double(bsdf.arrival_weight(direction(std::sqrt((float(i) + 0.5f) / n), 0)));
    EXPECT_NEAR(sum / n, 1, 1e-4) << roughness;
  }
}

// glTF 2.0, appendix B: a surface that is metal in part is the mixture of a dielectric and of a metal. Below a
// roughness of .23 no light is added for several microfacets, which is not linear in F0, so the mixture is exact, in
// each event and for what arrives. Seen to fail: the Lambert lobe below the mixed reflection, where a red metal of .3
// had 14 % less light of event D in all channels.
TEST(Metallic, IsTheMixtureOfDielectricAndMetal) {
  for (float roughness : {0.01f, 0.2f, 0.7f})
    for (float metallic : {0.02f, 0.3f, 0.9f}) {
      Material mixed = metal({0.6f, 0.03f, 0.02f}, roughness), bare = mixed;
      mixed.metallic = metallic, bare.metallic = 0;
      const Bsdf a(mixed), b(bare), c(metal(mixed.base_color, roughness));
      for (float cos : {0.05f, 0.4f, 0.9f}) {
        const Vec3 wo = direction(cos, 1), wi = direction(0.7f, 2);
        for (int channel = 0; channel < 3; ++channel) {
          const auto mixture = [&](Rgb of_bare, Rgb of_metal) {
            return double((1 - metallic) * of_bare[channel] + metallic * of_metal[channel]);
          };
          EXPECT_NEAR(a.eval_diffuse(wi, wo)[channel], mixture(b.eval_diffuse(wi, wo), Rgb(0.0f)), 1e-6);
          const double reflected = mixture(b.eval_specular(wi, wo), c.eval_specular(wi, wo));
          EXPECT_NEAR(a.eval_specular(wi, wo)[channel], reflected, 1e-6 + 1e-5 * reflected);
          EXPECT_NEAR(a.diffuse_reflectance(wo)[channel], mixture(b.diffuse_reflectance(wo), Rgb(0.0f)), 1e-6);
        }
        EXPECT_NEAR(a.arrival_weight(wo), b.arrival_weight(wo), 1e-6);
      }
    }
}

// In uniform light 1 at most 1 is reflected, for rho = 1, any F0 and all angles. For the S lobes the test uses the
// albedo from the table, corrected by the table's error against the integrals (other tests show that sample() and
// eval agree); for the Lambert lobe the table itself. With the term of Kulla and Conty a rough white metal reflects
// exactly all light. Seen to fail: the Lambert lobe in full under a coat.
TEST(Furnace, ReturnsAtMostWhatArrivesFromEitherSide) {
  const integrals::GaussLegendre rule(96);
  for (float roughness : {0.021f, 0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.75f, 1.0f}) {
    for (float metallic : {0.0f, 0.4f, 1.0f}) {
      for (float f0 : {0.0f, 0.04f, 0.5f, 1.0f}) {
        Material m = metal(Rgb(metallic == 1 ? f0 : 1.0f), roughness);
        m.metallic = metallic;
        const float root = std::sqrt(f0);
        m.ior = f0 < 1 ? (1 + root) / (1 - root) : 0;
        const Bsdf bsdf(m);
        for (float c : {1e-6f, 1e-4f, 1e-3f, 0.01f, 0.05f, 0.1f, 0.2f, 0.4f, 0.7f, 1.0f}) {
          const double alpha = double(roughness) * roughness;
          const integrals::Albedo e = integrals::ggx_albedo(c, alpha, rule);
          const AlbedoPair table = GgxAlbedo(float(alpha)).at(c);
          const double f90 = 1, f = metallic == 1 ? f0 : metallic + (1 - metallic) * f0;
          const double corrected =
              bsdf.specular_albedo(direction(c, 0)).r + f * (e.total - e.b - table.a) + f90 * (e.b - table.b);
          const double total = corrected + bsdf.diffuse_reflectance(direction(c, 0)).r;
          EXPECT_LE(total, 1 + 1e-4) << roughness << ' ' << metallic << ' ' << f0 << ' ' << c;
          if (metallic == 1 && f0 == 1 && roughness >= 0.35f) { EXPECT_NEAR(total, 1, 1e-4); }
        }
      }
    }
  }
}

/// Seen to fail: the coupling of the coat applied to one direction only.
TEST(Bsdf, IsReciprocal) {
  const PathRandom random(1, 0);
  for (const Material& m :
       {dielectric({0.8f, 0.5f, 0.2f}, 0.3f), metal({0.9f, 0.6f, 0.2f}, 0.9f), dielectric(Rgb(1.0f), 0.05f)}) {
    const Bsdf bsdf(m);
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const Vec3 a = sample_hemisphere_cos(random.get2(i, Purpose::test, 1));
      const Vec3 b = sample_hemisphere_cos(random.get2(i, Purpose::test, 2));
      const Rgb dab = bsdf.eval_diffuse(a, b), dba = bsdf.eval_diffuse(b, a);
      const Rgb sab = bsdf.eval_specular(a, b), sba = bsdf.eval_specular(b, a);
      EXPECT_NEAR(dab.r, dba.r, 1e-6f * dab.r);
      EXPECT_NEAR(sab.g, sba.g, 2e-5f * sab.g + 1e-9f);
    }
  }
}

void check_distribution(const Material& m, float cos_o) {
  test::expect_samples_follow_pdf(Bsdf(m), direction(cos_o, 0.7f),
                                  std::to_string(m.roughness) + ' ' + std::to_string(cos_o));
}

/// Seen to fail: the pdf of single reflection alone.
TEST(Bsdf, SamplesFallWhereThePdfSays) {
  for (float cos_o : {0.95f, 0.5f, 0.1f}) {
    check_distribution(dielectric(Rgb(0.5f), 0.4f), cos_o);
    check_distribution(metal(Rgb(0.8f), 1.0f), cos_o);
    check_distribution(metal(Rgb(0.8f), 0.5f), cos_o);
    check_distribution(dielectric(Rgb(0.5f), 0.8f, 0), cos_o);
  }
  check_distribution(dielectric(Rgb(0.5f), 0.7f), 0.01f);
  check_distribution(metal(Rgb(0.8f), 0.6f), 0.01f);
}

// A grid cannot resolve very narrow lobes: there the mean weight is compared with the albedo, which fails if sample()
// and pdf disagree. 2^14 Sobol points; the weight is G2/G1 F, almost always of one branch: error below 3e-3.
TEST(Bsdf, NarrowLobesKeepTheirLight) {
  for (float roughness : {0.021f, 0.05f, 0.15f, 0.3f})
    for (float c : {1e-6f, 1e-3f, 0.05f, 0.5f, 1.0f}) {
      const Bsdf bsdf(metal(Rgb(1.0f), roughness));
      EXPECT_NEAR(sampled_albedo(bsdf, direction(c, 1), false, 1 << 14).r, bsdf.specular_albedo(direction(c, 0)).r,
                  3e-3)
          << roughness << ' ' << c;
    }
}

TEST(Bsdf, IsFiniteAtEveryEdge) {
  const float edges[] = {0, 1e-38f, 1e-6f, 1e-3f, 0.5f, 1};
  for (float roughness : {0.0f, 0.02f, 0.021f, 0.3f, 1.0f})
    for (float base : {0.0f, 1.0f})
      for (float metallic : {0.0f, 0.5f, 1.0f})
        for (float specular : {0.0f, 1e-20f, 1.0f}) {
          Material m = metal(Rgb(base), roughness);
          m.metallic = metallic;
          m.specular = specular;
          const Bsdf bsdf(m);
          for (float co : edges) {
            const Vec3 wo = direction(co, 0);
            for (float ci : edges)
              for (const Vec3 wi : {direction(ci, 0), direction(ci, kPi), -wo, wo, Vec3{-wo.x, -wo.y, wo.z}}) {
                ASSERT_TRUE(is_finite(bsdf.eval_diffuse(wi, wo)));
                ASSERT_TRUE(is_finite(bsdf.eval_specular(wi, wo))) << roughness << ' ' << co << ' ' << ci;
                ASSERT_TRUE(std::isfinite(bsdf.pdf_diffuse(wi, wo)));
                ASSERT_TRUE(std::isfinite(bsdf.pdf_specular(wi, wo)));
              }
            for (float u : {0.0f, 0.5f, kOneMinusEpsilon})
              for (float v : {0.0f, 0.5f, kOneMinusEpsilon}) {
                const Bsdf::Sample s = bsdf.sample(wo, u, {v, u});
                ASSERT_TRUE(is_finite(s.weight) && is_finite(s.wi) && std::isfinite(s.pdf_solid_angle));
                ASSERT_LE(max_component(s.weight), 20.0f) << roughness << ' ' << base << ' ' << metallic << ' ' << co;
                if (!is_black(s.weight)) { ASSERT_GT(s.wi.z, 0); }
              }
          }
        }
}

TEST(Bsdf, ReflectsNothingBelowTheSurface) {
  const Bsdf bsdf(dielectric(Rgb(0.5f), 0.4f));
  const Vec3 up = direction(0.5f, 0), down = direction(-0.5f, 1);
  for (const auto& [wi, wo] : {std::pair{up, down}, std::pair{down, up}, std::pair{down, down}}) {
    EXPECT_TRUE(is_black(bsdf.eval_diffuse(wi, wo)) && is_black(bsdf.eval_specular(wi, wo)));
    EXPECT_EQ(bsdf.pdf_diffuse(wi, wo) + bsdf.pdf_specular(wi, wo), 0);
  }
  EXPECT_TRUE(is_black(bsdf.sample(down, 0.5f, {0.5f, 0.5f}).weight));
}

}  // namespace
}  // namespace tempolux
