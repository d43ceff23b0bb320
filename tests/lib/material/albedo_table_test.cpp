// The table of GGX's albedo against the integrals that it stores, and the generator of the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "lib/material/albedo.h"
#include "tests/lib/material/ggx_reference.h"

namespace tempolux {
namespace {

using namespace albedo_table;
using reference::Albedo;
using reference::GaussLegendre;

/// E at F = 1 and m of the header, at a position between the columns.
Albedo entry(int row, double position, const GaussLegendre& rule) {
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double mu = std::clamp(cos_of_column(position, alpha), 1e-6 * alpha, 1.0);
  Albedo e = reference::ggx_albedo(mu, alpha, rule);
  if (position == 0) e.total = 1;  // the limit: what grazes the surface is mirrored, nothing is masked twice
  return {e.total, (1 - std::pow(e.b / e.total, 0.2)) / (mu + alpha)};
}

/// The value of a table node. The fifth power bends sharply close to normal incidence, where b is below 1e-5 and m
/// has no weight: the m of the last column is chosen so that the cubic is exact at cos = 0.5, or in the middle of the
/// last interval if that is closer to the end.
Albedo node(int row, int column, const GaussLegendre& rule) {
  Albedo e = entry(row, double(column) / (kColumns - 1), rule);
  if (column < kColumns - 1) return e;
  const double alpha = alpha_of_row(double(row) / (kRows - 1));
  const double at = std::max(std::sqrt(0.5 * (1 + alpha) / (0.5 + alpha)), 1 - 0.5 / (kColumns - 1));
  const double s = at * (kColumns - 1) - (kColumns - 4), s1 = s - 1, s2 = s - 2, s3 = s - 3;
  const double weight[4] = {-s1 * s2 * s3 / 6, s * s2 * s3 / 2, -s * s1 * s3 / 2, s * s1 * s2 / 6};
  double rest = entry(row, at, rule).b;
  for (int i = 0; i < 3; ++i) rest -= weight[i] * entry(row, double(kColumns - 4 + i) / (kColumns - 1), rule).b;
  e.b = rest / weight[3];
  return e;
}

// For alpha = 1, D = 1/pi and normal incidence, u = cos h and cos_i = 2 u^2 - 1: the integral is elementary,
// E = 1 - ln 2.
TEST(GgxReference, IsOneMinusLn2ForTheRoughestSurfaceSeenStraightOn) {
  EXPECT_NEAR(reference::ggx_albedo(1, 1, GaussLegendre(48)).total, 1 - std::log(2.0), 1e-9);
}

// Every 7th node with 128 nodes instead of the 256 of the generator: the quadrature differs by less than 5e-6
// where it converges slowest, at grazing angles.
TEST(GgxAlbedoTable, HoldsTheIntegrals) {
  const GaussLegendre rule(128), outer(32);
  for (int i = 0; i < kRows * kColumns; i += 7) {
    const int row = i / kColumns, column = i % kColumns;
    const Albedo e = node(row, column, rule);
    EXPECT_NEAR(kTotal[row][column], e.total, 1e-5) << row << ' ' << column;
    EXPECT_NEAR(kCosine[row][column], e.b, 2e-4) << row << ' ' << column;
  }
  for (int row = 0; row < kRows; row += 5) {
    const Albedo e = reference::ggx_mean_albedo(alpha_of_row(double(row) / (kRows - 1)), outer, GaussLegendre(64));
    EXPECT_NEAR(kMeanA[row], e.total - e.b, 1e-5) << row;
    EXPECT_NEAR(kMeanB[row], e.b, 1e-5) << row;
  }
}

// Between the nodes, over the whole domain and closer to grazing than any node. The bounds are those of the header;
// measured 3.7e-5 and 6.6e-5.
TEST(GgxAlbedoTable, InterpolatesWithinItsBound) {
  const GaussLegendre rule(96);
  double worst_total = 0, worst_b = 0;
  for (int k = 0; k < 900; ++k) {
    const double alpha = alpha_of_row(std::fmod(k * 0.6180339887, 1.0)), position = (k + 0.5) / 900;
    const double mu = std::min(1.0, k % 2 ? cos_of_column(position, alpha) : position);
    const AlbedoPair table = GgxAlbedo(float(alpha)).at(float(mu));
    const Albedo e = reference::ggx_albedo(mu, alpha, rule);
    worst_total = std::max(worst_total, std::abs(table.a + table.b - e.total));
    worst_b = std::max(worst_b, std::abs(table.b - e.b));
  }
  RecordProperty("worst_total", std::to_string(worst_total));
  RecordProperty("worst_b", std::to_string(worst_b));
  EXPECT_LT(worst_total, 5e-5);
  EXPECT_LT(worst_b, 8e-5);
}

// The table has a column for the mean. It must be the mean of the values of at(), or the coupling of the Lambert lobe
// would not conserve energy. Tolerance 3e-5: both are interpolated.
TEST(GgxAlbedoTable, MeanIsTheMeanOfTheValues) {
  const GaussLegendre rule(200);
  for (double alpha : {4e-4, 1e-3, 7e-3, 0.03, 0.1, 0.27, 0.5, 0.77, 1.0}) {
    const GgxAlbedo albedo{float(alpha)};
    double a = 0, b = 0;
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
      const double v = rule.x[i], mu = v * v, weight = 4 * v * v * v * rule.weight[i];
      a += weight * albedo.at(float(mu)).a;
      b += weight * albedo.at(float(mu)).b;
    }
    EXPECT_NEAR(albedo.mean().a, a, 3e-5) << alpha;
    EXPECT_NEAR(albedo.mean().b, b, 3e-5) << alpha;
  }
}

void print_table(std::FILE* out, const char* name, const GaussLegendre& rule, bool cosine) {
  std::fprintf(out, "const float %s[kRows][kColumns] = {\n", name);
  for (int row = 0; row < kRows; ++row) {
    std::fprintf(out, "    {");
    for (int column = 0; column < kColumns; ++column) {
      const Albedo e = node(row, column, rule);
      std::fprintf(out, "%.7ff%s", cosine ? e.b : e.total,
                   column == kColumns - 1 ? "},\n"
                   : column % 8 == 7      ? ",\n     "
                                          : ", ");
    }
  }
  std::fprintf(out, "};\n");
}

// Writes lib/material/albedo_table.cpp: albedo_table_test --gtest_also_run_disabled_tests
// --gtest_filter='*WriteTheTable', run in tests/.
TEST(GgxAlbedoTable, DISABLED_WriteTheTable) {
  std::FILE* out = std::fopen("../lib/material/albedo_table.cpp", "w");
  ASSERT_NE(out, nullptr);
  std::fprintf(out,
               "// Generated by tests/lib/material/albedo_table_test.cpp, which also checks it.\n"
               "#include \"lib/material/albedo.h\"\n\nnamespace tempolux::albedo_table {\n\n");
  const GaussLegendre rule(256);
  print_table(out, "kTotal", rule, false);
  std::fprintf(out, "\n");
  print_table(out, "kCosine", rule, true);
  for (const bool b : {false, true}) {
    std::fprintf(out, "\nconst float kMean%s[kRows] = {\n    ", b ? "B" : "A");
    for (int row = 0; row < kRows; ++row) {
      const Albedo e =
          reference::ggx_mean_albedo(alpha_of_row(double(row) / (kRows - 1)), GaussLegendre(64), GaussLegendre(96));
      std::fprintf(out, "%.8ff%s", b ? e.b : e.total - e.b,
                   row == kRows - 1 ? "};\n"
                   : row % 7 == 6   ? ",\n    "
                                    : ", ");
    }
  }
  std::fprintf(out, "\n}  // namespace tempolux::albedo_table\n");
  std::fclose(out);
}

}  // namespace
}  // namespace tempolux
