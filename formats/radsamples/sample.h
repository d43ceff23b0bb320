// formats/radsamples/sample.h -- one sample of incoming radiance in 8 bytes (radsamples.md, section 4).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tempolux::formats {

/// Radiance of one cell, distance to what the ray met, age and what is known of it.
struct RadianceSample {
  std::array<std::uint8_t, 4> rgbe{};  ///< three mantissas, exponent
  std::uint16_t distance = 0;          ///< binary16 of 1024 d / diagonal; 0: nothing was met
  std::uint16_t flags = 1;             ///< age in the low 11 bits, then SampleFlags

  bool operator==(const RadianceSample&) const = default;
};
static_assert(sizeof(RadianceSample) == 8);

enum SampleFlags : std::uint16_t {
  sample_valid = 1 << 11,     ///< a ray was sent; else it would have started below the surface
  sample_dynamic = 1 << 12,   ///< it met what moves
  sample_miss = 1 << 13,      ///< it met nothing
  sample_near = 1 << 14,      ///< more came along it than its anchor's light times a constant
  sample_anchored = 1 << 15,  ///< its column entry names the point that stands for its hit
};
inline constexpr std::uint16_t kMaxAge = 2047;

inline std::uint16_t age_of(const RadianceSample& s) { return s.flags & kMaxAge; }

/// L = m 2^(e - 136) per channel, 0 if e < 10.
inline std::array<float, 3> decode_rgbe(const std::array<std::uint8_t, 4>& rgbe) {
  const float scale = rgbe[3] < 10 ? 0.0f : std::bit_cast<float>(std::uint32_t(rgbe[3] - 9) << 23);
  return {float(rgbe[0]) * scale, float(rgbe[1]) * scale, float(rgbe[2]) * scale};
}

/// The largest mantissa is 128 to 255; each is floor(L 2^(136 - e) + u), u in [0, 1): with u uniform the mean of what
/// is read is L. Values that a file holds come back for any u. What is not finite or below 0 counts as 0, what is above
/// 2^126 as that.
inline std::array<std::uint8_t, 4> encode_rgbe(std::array<float, 3> radiance, const std::array<float, 3>& u) {
  for (float& x : radiance) x = x > 0 ? std::min(x, 0x1p126f) : 0.0f;  // NaN compares false
  const float largest = std::max({radiance[0], radiance[1], radiance[2]});
  int e = int(std::bit_cast<std::uint32_t>(largest) >> 23) - 126 + 128;  // largest is in [2^(e - 129), 2^(e - 128))
  if (largest < 0x1p-118f) return {};
  for (;; ++e) {
    const float scale = std::bit_cast<float>(std::uint32_t(127 + 136 - e) << 23);
    std::array<std::uint32_t, 3> m{};
    for (std::size_t c = 0; c < 3; ++c) {
      const float x = radiance[c] * scale;
      m[c] = std::uint32_t(x);
      m[c] += (x - float(m[c])) + u[c] >= 1;
    }
    if (m[0] < 256 && m[1] < 256 && m[2] < 256)
      return {std::uint8_t(m[0]), std::uint8_t(m[1]), std::uint8_t(m[2]), std::uint8_t(e)};
  }
}

/// A number from 2^-14 to 65504 as binary16, rounded to nearest, ties to even; nearer ends of that range for others.
inline std::uint16_t encode_half(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(std::clamp(x, 0x1p-14f, 65504.0f)) - (112u << 23);
  return std::uint16_t((bits + 0xfff + ((bits >> 13) & 1)) >> 13);
}
/// What encode_half() wrote; 0 as about 0.
inline float decode_half(std::uint16_t h) { return std::bit_cast<float>((std::uint32_t(h) << 13) + (112u << 23)); }

}  // namespace tempolux::formats
