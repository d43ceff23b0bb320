#include "formats/exact_sum.h"

#include <cmath>

namespace tempolux::formats {

double ExactSum::rounded() const {
  // Converts the bins to an integer of 11 limbs of 32 bits, in units of 2^-149. Each limb first sums the low halves
  // and the high parts of its bins; then carries are added to the next limbs.
  std::array<std::int64_t, 11> limbs{};
  for (std::size_t e = 0; e < 256; ++e) {
    const std::size_t shift = e == 0 ? 0 : e - 1, limb = shift / 32;
    const std::int64_t bin = bins_[e] - bins_[256 + e];
    const std::int64_t low = (bin & 0xffffffff) << (shift % 32);
    const std::int64_t high = (bin >> 32) * (std::int64_t(1) << (shift % 32));
    limbs[limb] += low & 0xffffffff;
    limbs[limb + 1] += (low >> 32) + (high & 0xffffffff);
    limbs[limb + 2] += high >> 32;
  }
  const auto carry = [&limbs] {
    for (std::size_t i = 0; i + 1 < limbs.size(); ++i) {
      limbs[i + 1] += limbs[i] >> 32;
      limbs[i] &= 0xffffffff;
    }
  };
  carry();
  const bool negative = limbs.back() < 0;
  if (negative) {
    for (std::int64_t& limb : limbs) limb = -limb;
    carry();
  }
  // The highest 64 bits decide the result; lower bits only break ties.
  int top = int(limbs.size()) - 1;
  while (top > 0 && limbs[std::size_t(top)] == 0) --top;
  const auto limb = [&](int i) { return i >= 0 ? std::uint64_t(limbs[std::size_t(i)]) : 0; };
  const int gap = std::countl_zero(std::uint32_t(limb(top)));  // 0 .. 32
  std::uint64_t high = (limb(top) << 32) | limb(top - 1);
  if (gap > 0) high = (gap < 64 ? high << gap : 0) | (limb(top - 2) >> (32 - gap));
  bool rest = (limb(top - 2) & ((std::uint64_t(1) << (32 - gap)) - 1)) != 0;
  for (int i = top - 3; i >= 0; --i) rest = rest || limb(i) != 0;
  const double magnitude = std::ldexp(double(high | std::uint64_t(rest)), 32 * (top - 1) - gap - 149);
  return negative ? -magnitude : magnitude;
}

}  // namespace tempolux::formats
