// tests/support/distribution.h -- compares the directions that a Bsdf draws with its pdf.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lib/core/random.h"
#include "lib/material/bsdf.h"
#include "tests/support/materials.h"

namespace tempolux::test {

/// Chi-square of k cells has the mean k - 1 and the variance 2 (k - 1): expects at most the mean + 5 sigma. Cells in
/// which fewer than 10 samples are expected count together.
inline void expect_chi_square(const std::vector<double>& expected, const std::vector<double>& seen,
                              const std::string& what) {
  double chi2 = 0, pooled_expected = 0, pooled_seen = 0;
  int cells = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (expected[i] < 10) {
      pooled_expected += expected[i];
      pooled_seen += seen[i];
      continue;
    }
    chi2 += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
    ++cells;
  }
  if (pooled_expected > 10) {
    chi2 += (pooled_seen - pooled_expected) * (pooled_seen - pooled_expected) / pooled_expected;
    ++cells;
  }
  EXPECT_LT(chi2, cells - 1 + 5 * std::sqrt(2.0 * (cells - 1))) << what << ' ' << cells;
}

/// Cells of equal cos and phi, above the surface or over the whole sphere. The pdf of a cell is its mean at sub x sub
/// points.
struct Cells {
  int cos = 12, phi = 16, sub = 64;
  bool sphere = false;

  double least() const { return sphere ? -1 : 0; }
  double solid_angle() const { return (1 - least()) * 2 * std::numbers::pi; }
  /// The cell of a direction.
  std::size_t of(Vec3 w) const {
    const float turn = std::atan2(w.y, w.x), round = turn < 0 ? turn + 2 * kPi : turn;
    const int a = std::clamp(int((w.z - float(least())) / float(1 - least()) * float(cos)), 0, cos - 1),
              b = std::min(phi - 1, int(round / (2 * kPi) * float(phi)));
    return std::size_t(a * phi + b);
  }
};

/// Directions of sample(), counted in cells, against the pdf integrated over the cells. Samples of pdf 0, such as those
/// below the horizon, count as one more cell. The pdf integrates to 1 less the share of samples that are lost so.
/// each(sample) is called for every other sample.
template <class Each>
void expect_samples_follow_pdf(const Bsdf& bsdf, Vec3 wo, const std::string& what, const Cells& cells,
                               const Each& each) {
  constexpr int kCount = 200000;
  const int n = cells.cos * cells.sub, m = cells.phi * cells.sub;
  std::vector<double> expected(std::size_t(cells.cos * cells.phi), 0), seen(expected.size(), 0);
  const Bsdf::Direction o = bsdf.along(wo);
  double inside = 0, lost = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double cos = cells.least() + (1 - cells.least()) * (i + 0.5) / n;
      const Vec3 wi = direction(float(cos), 2 * kPi * (float(j) + 0.5f) / float(m));
      const double p =
          (double(bsdf.pdf_diffuse(wi, o)) + double(bsdf.pdf_specular(wi, o))) * cells.solid_angle() / (double(n) * m);
      expected[std::size_t(i / cells.sub * cells.phi + j / cells.sub)] += p * kCount;
      inside += p;
    }
  const PathRandom random(3, 5);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Bsdf::Sample s = bsdf.sample(wo, random.get1(i, Purpose::lobe), random.get2(i, Purpose::scatter));
    if (!(s.pdf_solid_angle > 0)) {
      ++lost;
      continue;
    }
    ASSERT_NEAR(s.pdf_solid_angle, bsdf.pdf_diffuse(s.wi, o) + bsdf.pdf_specular(s.wi, o), 2e-3f * s.pdf_solid_angle)
        << what;
    each(s);
    ++seen[cells.of(s.wi)];
  }
  EXPECT_NEAR(inside + lost / kCount, 1, 1e-3 + 4 * std::sqrt(lost) / kCount) << what;
  expected.push_back(std::max(0.0, 1 - inside) * kCount);
  seen.push_back(lost);
  expect_chi_square(expected, seen, what);
}

/// The same above the surface.
inline void expect_samples_follow_pdf(const Bsdf& bsdf, Vec3 wo, const std::string& what) {
  expect_samples_follow_pdf(bsdf, wo, what, {}, [](const Bsdf::Sample&) {});
}

/// Expects f(a, b) = f(b, a) of both events, for 20 pairs of directions that follow from `seed`.
inline void expect_reciprocal(const Bsdf& bsdf, std::uint32_t seed) {
  const PathRandom random(1, seed);
  for (std::uint32_t j = 0; j < 20; ++j) {
    const Vec3 a = sample_hemisphere_cos(random.get2(j, Purpose::test, 1));
    const Vec3 b = sample_hemisphere_cos(random.get2(j, Purpose::test, 2));
    const Rgb specular = bsdf.eval_specular(a, b), turned = bsdf.eval_specular(b, a);
    const Rgb diffuse = bsdf.eval_diffuse(a, b), diffuse_turned = bsdf.eval_diffuse(b, a);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(specular[c], turned[c], 1e-4f * specular[c] + 1e-8f) << seed;
      EXPECT_NEAR(diffuse[c], diffuse_turned[c], 1e-5f) << seed;
    }
  }
}

}  // namespace tempolux::test
