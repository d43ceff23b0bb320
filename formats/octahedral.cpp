#include "formats/octahedral.h"

#include <cmath>

namespace tempolux::formats {

std::array<float, 3> decode_normal(std::array<std::uint16_t, 2> code) {
  double p = (double(code[0]) - 32767) / 32767, q = (double(code[1]) - 32767) / 32767;
  const double z = 1 - std::abs(p) - std::abs(q);
  if (z < 0) {
    const double folded = (1 - std::abs(q)) * (p < 0 ? -1 : 1);
    q = (1 - std::abs(p)) * (q < 0 ? -1 : 1);
    p = folded;
  }
  const double length = std::sqrt(p * p + q * q + z * z);
  return {float(p / length), float(q / length), float(z / length)};
}

}  // namespace tempolux::formats
