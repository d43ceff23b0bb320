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

/// Chi-square of k cells has the mean k - 1 and the variance 2 (k - 1): expects at most the mean + 5 sigma. Cells in which
/// fewer than 10 samples are expected count together.
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

/// Directions of sample(), counted in 12 x 16 cells of equal cos and phi above the surface, against the pdf integrated
/// over the cells (64 x 64 points each). Samples below the horizon count as one more cell. The pdf integrates to 1 less
/// the share of samples that are lost so.
inline void expect_samples_follow_pdf(const Bsdf& bsdf, Vec3 wo, const std::string& what) {
  constexpr int kCos = 12, kPhi = 16, kSub = 64, kCount = 200000;
  std::vector<double> expected(kCos * kPhi, 0), seen(kCos * kPhi, 0);
  const Bsdf::Direction o = bsdf.along(wo);
  double inside = 0, lost = 0;
  for (int i = 0; i < kCos * kSub; ++i)
    for (int j = 0; j < kPhi * kSub; ++j) {
      const Vec3 wi = direction((float(i) + 0.5f) / (kCos * kSub), 2 * kPi * (float(j) + 0.5f) / (kPhi * kSub));
      const double p = (double(bsdf.pdf_diffuse(wi, o)) + double(bsdf.pdf_specular(wi, o))) * 2 * std::numbers::pi /
                       (kCos * kSub * double(kPhi * kSub));
      expected[std::size_t(i / kSub * kPhi + j / kSub)] += p * kCount;
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
    const float phi = std::atan2(s.wi.y, s.wi.x), turn = phi < 0 ? phi + 2 * kPi : phi;
    const int a = std::min(kCos - 1, int(s.wi.z * kCos)), b = std::min(kPhi - 1, int(turn / (2 * kPi) * kPhi));
    ++seen[std::size_t(a * kPhi + b)];
  }
  EXPECT_NEAR(inside + lost / kCount, 1, 1e-3 + 4 * std::sqrt(lost) / kCount) << what;
  expected.push_back(std::max(0.0, 1 - inside) * kCount);
  seen.push_back(lost);
  expect_chi_square(expected, seen, what);
}

}  // namespace tempolux::test
