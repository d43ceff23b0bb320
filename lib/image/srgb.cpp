#include "lib/image/srgb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tempolux {

float srgb_to_linear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linear_to_srgb(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

namespace {

/// Codes at 128 places of each octave from kFirst up to 1, in between straight lines: off by 4e-4 codes at most.
struct CodeTable {
  static constexpr int kShift = 52 - 7;  // bits of a double's mantissa between two places
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(0x1p-9) >> kShift,
                                 kLast = std::bit_cast<std::uint64_t>(1.0) >> kShift;
  std::array<double, kLast - kFirst + 2> codes;
  CodeTable() {
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const double v = std::min(1.0, std::bit_cast<double>((kFirst + i) << kShift));
      codes[i] = 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
    }
  }
  double at(double v) const {
    const auto bits = std::bit_cast<std::uint64_t>(v);
    const double* code = &codes[(bits >> kShift) - kFirst];
    const double share = double(bits & ((1ull << kShift) - 1)) * 0x1p-45;
    return code[0] + share * (code[1] - code[0]);
  }
};

}  // namespace

double srgb_code(double value) {
  static const CodeTable table;
  const double v = std::clamp(value, 0.0, 1.0);
  return v <= 0.0031308 ? 255 * 12.92 * v : table.at(v);
}

}  // namespace tempolux
