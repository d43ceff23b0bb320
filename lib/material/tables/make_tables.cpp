// make_material_tables FILE -- writes the C++ source of the tables of albedo.h, glass_albedo.h, anisotropic_ggx.h,
// sheen.h and dispersion.h. The build runs it.
#include <cstdio>
#include <span>

#include "lib/material/tables/nodes.h"
#include "lib/material/tables/spectrum_integrals.h"

namespace tempolux {
namespace {

/// Writes numbers as a nested initialiser with these sizes, the last index varying fastest; returns what follows the
/// numbers that were written.
const double* print(std::FILE* out, std::span<const int> sizes, const double* values) {
  if (sizes.empty()) {
    std::fprintf(out, "%.8ff", *values);
    return values + 1;
  }
  std::fputc('{', out);
  for (int i = 0; i < sizes[0]; ++i) {
    values = print(out, sizes.subspan(1), values);
    std::fputs(i + 1 < sizes[0] ? sizes.size() == 1 ? ", " : ",\n" : "}", out);
  }
  return values;
}

void define(std::FILE* out, const char* declaration, std::initializer_list<int> sizes,
            const std::vector<double>& values) {
  std::fprintf(out, "const float %s = ", declaration);
  print(out, sizes, values.data());
  std::fputs(";\n", out);
}

void write_albedo(std::FILE* out) {
  using namespace albedo_table;
  const integrals::GaussLegendre rule(128), outer(64);
  std::vector<double> total, cosine, mean_a, mean_b;
  for (int column = 0; column < kColumns; ++column) {
    for (int row = 0; row < kRows; ++row) {
      const integrals::Albedo e = node(row, column, rule);
      total.push_back(e.total);
      cosine.push_back(e.b);
    }
  }
  for (int row = 0; row < kRows; ++row) {
    const integrals::Albedo mean = integrals::ggx_mean_albedo(alpha_of_row(double(row) / (kRows - 1)), outer, rule);
    mean_a.push_back(mean.total - mean.b);
    mean_b.push_back(mean.b);
  }
  std::fputs("namespace tempolux::albedo_table {\n", out);
  define(out, "kTotal[kColumns][kRows]", {kColumns, kRows}, total);
  define(out, "kCosine[kColumns][kRows]", {kColumns, kRows}, cosine);
  define(out, "kMeanA[kRows]", {kRows}, mean_a);
  define(out, "kMeanB[kRows]", {kRows}, mean_b);
  std::fputs("}  // namespace tempolux::albedo_table\n", out);
}

void write_glass(std::FILE* out) {
  using namespace glass_table;
  std::vector<double> loss, mean;
  for (int side = 0; side < 2; ++side)
    for (int plane = 0; plane < kPlanes; ++plane)
      for (int row = 0; row < kRows; ++row) {
        std::vector<double> values;
        for (int column = 0; column < kColumns; ++column) values.push_back(node(side, plane, row, column, 256));
        loss.insert(loss.end(), values.begin(), values.end());
        mean.push_back(mean_of_row(side, plane, row, values));
      }
  std::fputs("namespace tempolux::glass_table {\n", out);
  define(out, "kLoss[2][kPlanes][kRows][kColumns]", {2, kPlanes, kRows, kColumns}, loss);
  define(out, "kMean[2][kPlanes][kRows]", {2, kPlanes, kRows}, mean);
  std::fputs("}  // namespace tempolux::glass_table\n", out);
}

void write_anisotropic(std::FILE* out) {
  using namespace anisotropic_table;
  std::vector<double> albedo, mean;
  for (int row = 0; row < kRows; ++row)
    for (int width = 0; width < kWidths; ++width) {
      std::vector<integrals::Albedo> nodes;
      for (int column = 0; column < kColumns; ++column)
        for (int turn = 0; turn < kTurns; ++turn) {
          nodes.push_back(node(row, width, column, turn));
          albedo.insert(albedo.end(), {nodes.back().total, nodes.back().b});
        }
      const integrals::Albedo m = mean_of(row, width, nodes);
      mean.insert(mean.end(), {m.total, m.b});
    }
  std::fputs("namespace tempolux::anisotropic_table {\n", out);
  define(out, "kAlbedo[kRows][kWidths][kColumns][kTurns][2]", {kRows, kWidths, kColumns, kTurns, 2}, albedo);
  define(out, "kMean[kRows][kWidths][2]", {kRows, kWidths, 2}, mean);
  std::fputs("}  // namespace tempolux::anisotropic_table\n", out);
}

void write_sheen(std::FILE* out) {
  using namespace sheen_table;
  const integrals::GaussLegendre rule(64);
  std::vector<double> albedo, mean;
  for (int row = 0; row < kRows; ++row) {
    const Row values(double(row) / (kRows - 1), rule);
    for (int column = 0; column < kColumns; ++column)
      albedo.insert(albedo.end(), {values.albedo[std::size_t(column)], values.raw[std::size_t(column)]});
    mean.push_back(values.mean());
  }
  std::fputs("namespace tempolux::sheen_table {\n", out);
  define(out, "kAlbedo[kRows][kColumns][2]", {kRows, kColumns, 2}, albedo);
  define(out, "kMean[kRows]", {kRows}, mean);
  std::fputs("}  // namespace tempolux::sheen_table\n", out);
}

void write_spectrum(std::FILE* out) {
  using namespace spectrum_table;
  const integrals::Spectrum spectrum;
  std::fputs("namespace tempolux::spectrum_table {\n", out);
  define(out, "kWavelength[kSteps + 1]", {kSteps + 1}, spectrum.wavelength);
  define(out, "kColor[kSteps + 1][3]", {kSteps + 1, 3}, spectrum.color);
  std::fputs("}  // namespace tempolux::spectrum_table\n", out);
}

}  // namespace
}  // namespace tempolux

int main(int argc, char** argv) {
  std::FILE* out = argc == 2 ? std::fopen(argv[1], "w") : nullptr;
  if (!out) return 2;
  std::fputs(
      "#include \"lib/material/albedo.h\"\n#include \"lib/material/glass_albedo.h\"\n"
      "#include \"lib/material/anisotropic_ggx.h\"\n#include \"lib/material/sheen.h\"\n"
      "#include \"lib/material/dispersion.h\"\n\n",
      out);
  tempolux::write_albedo(out);
  tempolux::write_glass(out);
  tempolux::write_anisotropic(out);
  tempolux::write_sheen(out);
  tempolux::write_spectrum(out);
  return std::fclose(out) ? 1 : 0;
}
