// Thin films (KHR_materials_iridescence): the exact formula of Airy, energy, reciprocity, samples.
#include "lib/material/thin_film.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lib/core/random.h"
#include "lib/core/sobol.h"
#include "lib/material/bsdf.h"
#include "lib/material/tables/spectrum_integrals.h"
#include "tests/support/distribution.h"
#include "tests/support/materials.h"

namespace tempolux {
namespace {

using test::direction;

const Frame kFrame(Vec3{0, 0, 1});

double squared(double x) { return x * x; }

/// Airy's reflectance of a film between air and a base at normal incidence; thickness and wavelength in nm.
double airy(double film, double base, double thickness, double nm) {
  const double r12 = (1 - film) / (1 + film), r23 = (film - base) / (film + base);
  const double cos = std::cos(4 * M_PI * film * thickness / nm);
  return (r12 * r12 + r23 * r23 + 2 * r12 * r23 * cos) / (1 + r12 * r12 * r23 * r23 + 2 * r12 * r23 * cos);
}

// Oil on water, water on glass, a dense film on glass, at single wavelengths. The series ends after m = 2. The first
// term that is left out, 2 (R12 R23)^1.5, is at most .02 % of R for the first two and .1 % for the dense film. Seen to
// fail with the sign of the phase reversed, and with m = 1 alone for the dense film.
TEST(ThinFilm, IsAirysFormulaAtEachWavelength) {
  for (const auto& [film, base] : {std::pair{1.47, 1.33}, {1.33, 1.5}, {1.8, 1.5}})
    for (double thickness : {150.0, 400.0, 900.0})
      for (double nm = 400; nm < 700; nm += 7) {
        const double outer = squared((film - 1) / (film + 1)), inner = squared((film - base) / (film + base));
        const double phase = 4 * M_PI * film * thickness / nm, sign = base < film ? 1 : -1;
        const float model =
            film_reflectance(float(outer), float(inner), float(sign * std::cos(phase)), float(std::cos(2 * phase)));
        const double exact = airy(film, base, thickness, nm);
        EXPECT_NEAR(double(model), exact, 0.003 * exact) << film << ' ' << thickness << ' ' << nm;
      }
}

/// Airy's reflectance in XYZ: its mean over the phase, and the rest weighed by the CIE curves.
std::array<double, 3> seen(double film, double base, double thickness) {
  double mean = 0;
  for (int i = 0; i < 1000; ++i) mean += airy(film, base, thickness, 4 * film * thickness / (i / 500.0 + 0.001)) / 1000;
  std::array<double, 3> flat{}, swing{};
  for (double nm = 360; nm < 830; nm += 0.5) {
    const auto xyz = integrals::cie_xyz(nm);
    for (std::size_t c = 0; c < 3; ++c)
      flat[c] += xyz[c], swing[c] += xyz[c] * (airy(film, base, thickness, nm) - mean);
  }
  return {swing[0] / flat[0], swing[1] / flat[1], swing[2] / flat[2]};
}

// At normal incidence, against Airy's formula and the CIE curves. Only the curves' fit differs: in light of a single
// wave number it is within 6 % of the height of each curve, so each of X, Y, Z is within 6 % of the film's swing,
// 2 T12 sqrt(R12 R23). Seen to fail with the red curve's violet lobe left out, with the sign of the phase reversed, and
// with half the thickness.
TEST(ThinFilm, HasTheColourOfAirysFormula) {
  double worst = 0;
  for (const auto& [film, base] : {std::pair{1.33f, 1.5f}, {1.47f, 1.33f}, {1.8f, 1.5f}})
    for (float thickness : {100.0f, 200.0f, 300.0f, 400.0f, 550.0f, 800.0f, 1200.0f}) {
      const double n = double(film), b = double(base), outer = squared((n - 1) / (n + 1)),
                   inner = squared((n - b) / (n + b));
      const double mean = outer + squared(1 - outer) * inner / (1 - outer * inner), f0 = squared((b - 1) / (b + 1));
      const Rgb model = ThinFilm({Rgb(float(f0)), 1}, 1, film, thickness).at(1);
      if (!(std::min({model.r, model.g, model.b}) > 0)) continue;  // limited: no such colour on a screen
      const Rgbd swing = Rgbd(model) - Rgbd(mean);
      const std::array<double, 3> xyz{0.4124564 * swing.r + 0.3575761 * swing.g + 0.1804375 * swing.b,
                                      0.2126729 * swing.r + 0.7151522 * swing.g + 0.0721750 * swing.b,
                                      0.0193339 * swing.r + 0.1191920 * swing.g + 0.9503041 * swing.b};
      const std::array<double, 3> exact = seen(n, b, double(thickness));
      const double height = 2 * (1 - outer) * std::sqrt(outer * inner);
      for (std::size_t c = 0; c < 3; ++c) {
        worst = std::max(worst, std::abs(xyz[c] - exact[c]) / height);
        EXPECT_NEAR(xyz[c], exact[c], 0.06 * height) << film << ' ' << base << ' ' << thickness << ' ' << c;
      }
    }
  RecordProperty("worst", std::to_string(worst));
}

Material with_film(float metallic, float roughness, float index = 1.33f, float thickness = 400) {
  Material m;
  m.metallic = metallic;
  m.base_color = Rgb(1.0f);
  m.roughness = roughness;
  m.iridescence = 1, m.iridescence_ior = index, m.iridescence_thickness_maximum = thickness;
  return m;
}
Bsdf bsdf_of(const Material& m) { return Bsdf(m, true, kFrame); }

/// A film of an everyday soap, oil or oxide on a random base.
Material random_film(std::uint32_t i) {
  const PathRandom random(23, i);
  const auto u = [&](std::uint32_t n) { return random.get1(n, Purpose::test); };
  Material m = with_film(u(0) < 0.3f ? 1 : 0, u(1), 1.2f + 0.8f * u(2), 100 + 900 * u(3));
  m.ior = 1.3f + 0.7f * u(4);
  m.base_color = {u(5), u(6), u(7)};
  if (u(8) < 0.4f) m.anisotropy = u(9), m.axes.grain = direction(0, 6 * u(10));
  if (u(11) < 0.5f) m.iridescence = u(12);
  return m;
}

// Without a factor the film's other properties have no effect on any bit. Seen to fail with the factor left out.
TEST(ThinFilm, OfFactorZeroIsThePlainReflection) {
  for (float roughness : {0.0f, 0.3f, 1.0f}) {
    Material plain, none = with_film(0.5f, roughness, 1.8f, 700);
    plain.metallic = 0.5f, plain.roughness = roughness;
    none.iridescence = 0;
    const Bsdf a = bsdf_of(plain), b = bsdf_of(none);
    const Vec3 wi = direction(0.4f, 1), wo = direction(0.7f, 3);
    EXPECT_EQ(a.eval_specular(wi, wo), b.eval_specular(wi, wo));
    EXPECT_EQ(a.eval_diffuse(wi, wo), b.eval_diffuse(wi, wo));
    for (std::uint32_t i = 0; i < 16; ++i) {
      const Bsdf::Sample s = a.sample(wo, sobol_owen_1d(i, 7), sobol_owen_2d(i, 11)),
                         t = b.sample(wo, sobol_owen_1d(i, 7), sobol_owen_2d(i, 11));
      EXPECT_EQ(s.wi, t.wi);
      EXPECT_EQ(s.weight, t.weight);
      EXPECT_EQ(s.pdf_solid_angle, t.pdf_solid_angle);
    }
  }
}

// The albedo that couples the Lambert lobe, against 64 x 64 visible normals. Seen to fail with Schlick's share alone,
// and with the normals of one half of a lobe whose plane is not y = 0.
TEST(ThinFilm, AlbedoIsTheIntegral) {
  double worst = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const PathRandom random(3, i);
    const auto u = [&](std::uint32_t n) { return random.get1(n, Purpose::test); };
    const float ior = 1.3f + 0.7f * u(0), f0 = (ior - 1) / (ior + 1) * (ior - 1) / (ior + 1),
                alpha = 0.003f + 0.997f * u(4) * u(4);
    const ThinFilm film({Rgb(f0), 1}, 1, 1.2f + 0.8f * u(1), 100 + 900 * u(2));
    const RoundGgx width(alpha);
    const Vec3 w = direction(std::max(0.05f, u(3)), 6 * u(5));
    Rgbd sum(0.0);
    double all = 0;
    constexpr int kSide = 64;
    for (int k = 0; k < kSide * kSide; ++k) {
      const Vec2 at{(float(k % kSide) + 0.5f) / kSide, (float(k / kSide) + 0.5f) / kSide};
      const Vec3 h = width.sample_normal(w, at), wi = h * (2 * dot(w, h)) - w;
      if (!(wi.z > 0)) continue;
      const double weight = double(width.reflection(wi, w, h) * wi.z / width.pdf_reflected(h, w));
      sum += Rgbd(film.at(dot(w, h))) * weight, all += weight;
    }
    const AlbedoPair e = width.albedo(w);
    const Rgb albedo = film.albedo(width, w, e);
    worst = std::max(worst, std::abs(double(max_component(albedo)) - max_component(sum) * double(e.a + e.b) / all));
  }
  EXPECT_LT(worst, 0.012);
  RecordProperty("worst", std::to_string(worst));
}

/// Mean weight of 2^bits samples, over both events.
Rgbd sampled(const Bsdf& bsdf, Vec3 wo, int bits) {
  Rgbd sum(0.0);
  for (std::uint32_t i = 0; i < 1u << bits; ++i)
    sum += Rgbd(bsdf.sample(wo, sobol_owen_1d(i, 7), sobol_owen_2d(i, 11)).weight);
  return sum * (1.0 / (1 << bits));
}

// Uniform radiance 1. A film on a white metal, which absorbs nothing, returns all light in every channel, up to what
// GGX loses below the fade of f_ms (BasicGloss). A film on a dielectric above a white Lambert lobe returns all light in
// the channel that the film reflects most: the Lambert lobe gets what this channel leaves. The noise is .3 %. Seen to
// fail with the film's mean albedo by Schlick, and with the largest channel of the mean in place of the mean of the
// largest (losses of 2.5 to 2.7 %).
TEST(Furnace, FilmsLoseAndMakeNoLight) {
  double most = 0, least = 2;
  for (float roughness : {0.0f, 0.1f, 0.2f, 0.35f, 0.6f, 1.0f})
    for (float index : {1.2f, 1.33f, 1.6f, 2.0f})
      for (float thickness : {120.0f, 300.0f, 500.0f, 900.0f})
        for (float cos : {0.1f, 0.3f, 0.6f, 1.0f}) {
          const Vec3 wo = direction(cos, 1);
          const double dielectric = max_component(sampled(bsdf_of(with_film(0, roughness, index, thickness)), wo, 12));
          EXPECT_NEAR(dielectric, 1, 0.023) << roughness << ' ' << index << ' ' << thickness << ' ' << cos;
          most = std::max(most, dielectric), least = std::min(least, dielectric);
          const Rgbd metal = sampled(bsdf_of(with_film(1, roughness, index, thickness)), wo, 10);
          EXPECT_LE(max_component(metal), 1.012) << roughness << ' ' << index << ' ' << cos;
          if (roughness >= 0.35f || roughness == 0) { EXPECT_GE(std::min({metal.r, metal.g, metal.b}), 0.98); }
        }
  RecordProperty("furnace", std::to_string(least) + " " + std::to_string(most));
}

// Seen to fail with the term taken at the cosine of wo to the surface's normal.
TEST(ThinFilm, IsReciprocal) {
  for (std::uint32_t i = 0; i < 200; ++i) test::expect_reciprocal(bsdf_of(random_film(i)), i);
}

// The pdf integrates to 1, samples are where the pdf says (chi-square), and weigh f cos / pdf. Seen to fail with a
// share of several reflections in the pdf that is not the one of the samples.
TEST(ThinFilm, SamplesFallWhereThePdfSays) {
  for (const auto& [metallic, cos] : {std::pair{0.0f, 0.9f}, {1.0f, 0.4f}}) {
    Material m = with_film(metallic, 0.5f, 1.6f, 500);
    m.base_color = {0.9f, 0.6f, 0.2f};
    const Vec3 wo = direction(cos, 0.7f);
    test::expect_samples_follow_pdf(bsdf_of(m), wo, "round");
    m.anisotropy = 0.7f, m.axes.grain = direction(0, 0.5f);
    const Bsdf bsdf = bsdf_of(m);
    test::expect_samples_follow_pdf(bsdf, wo, "brushed");
    for (std::uint32_t i = 0; i < 64; ++i) {
      const Bsdf::Sample s = bsdf.sample(wo, sobol_owen_1d(i, 3), sobol_owen_2d(i, 5));
      if (s.diffuse || is_black(s.weight)) continue;
      const Rgb f = bsdf.eval_specular(s.wi, wo) * (s.wi.z / bsdf.pdf_specular(s.wi, wo));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(s.weight[c], f[c], 2e-4f * f[c] + 1e-6f);
    }
  }
}

// Smooth glass below a film: what is not reflected passes, in each channel, through a solid from both sides and through
// a pane. Light that leaves a solid is reflected as light that enters along the same way (Stokes). Seen to fail with
// the cosine inside in place of that outside.
TEST(ThinFilm, OnGlassReflectsAlikeFromBothSides) {
  Material m = test::glass(0);
  m.iridescence = 1, m.iridescence_ior = 1.33f, m.iridescence_thickness_maximum = 350;
  Material pane = m;
  pane.thin_walled = true;
  for (float cos : {0.2f, 0.5f, 1.0f}) {
    const Rgb film = ThinFilm({Rgb(0.04f), 1}, 1, 1.33f, 350).at(cos);
    const float cos_inside = std::sqrt(1 - (1 - cos * cos) / 2.25f);
    const std::array<Bsdf, 3> of{Bsdf(m, true), Bsdf(m, false), Bsdf(pane)};
    for (const Bsdf& bsdf : of) {
      const bool inside = &bsdf == &of[1];
      const Vec3 wo = direction(inside ? cos_inside : cos, 1);
      Rgbd reflected(0.0), passed(0.0);
      constexpr int kCount = 20000;
      for (int i = 0; i < kCount; ++i) {
        const Bsdf::Sample s = bsdf.sample(wo, (float(i) + 0.5f) / kCount, {});
        (s.transmitted ? passed : reflected) += Rgbd(s.weight) * (1.0 / kCount);
      }
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(reflected[c], double(film[c]), 2e-4) << cos << ' ' << inside;
        EXPECT_NEAR(passed[c], 1 - double(film[c]), 2e-3) << cos << ' ' << inside;
      }
    }
    EXPECT_NEAR(Bsdf(pane).passed_straight(cos).g, 1 - film.g, 1e-6f);
    EXPECT_EQ(Bsdf(m, false).sample(direction(0.5f, 0), 0.999f, {}).weight, Rgb(1.0f)) << "totally reflected";
  }
}

}  // namespace
}  // namespace tempolux
