// formats/octahedral.h -- stores unit vectors in two 16-bit numbers (conventions.md, "Octahedral normals").
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace tempolux::formats {

/// Octahedral encoding (conventions.md): converts a vector of any length above 0 to two numbers of 0 .. 65534;
/// decoding returns a vector of unit length within 1e-7. The axes are exact; other directions err by at most 6.5e-5
/// rad. Encoding has no branches, since processors cannot predict the direction of normals.
inline std::array<std::uint16_t, 2> encode_normal(std::array<float, 3> n) {
  const double x = n[0], y = n[1], z = n[2], s = std::abs(x) + std::abs(y) + std::abs(z), p = x / s, q = y / s;
  const double below = z < 0, above = 1 - below, a = std::abs(p),
               b = std::abs(q);                     // one is 1, one is 0: products exact
  const auto code = [](double size, double sign) {  // + 0: -0 counts as positive
    return std::uint16_t(int(std::floor(32767 * std::copysign(size, sign + 0.0) + 0.5)) + 32767);
  };
  return {code(a * above + (1 - b) * below, p), code(b * above + (1 - a) * below, q)};
}
std::array<float, 3> decode_normal(std::array<std::uint16_t, 2> code);

}  // namespace tempolux::formats
