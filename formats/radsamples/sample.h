// formats/radsamples/sample.h -- one sample of incoming radiance in 8 bytes (radsamples.md, section 4).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tempolux::formats {

/// The radiance of one cell, the distance to the hit, the age of the ray, and flags.
struct RadianceSample {
  std::array<std::uint8_t, 4> rgbe{};  ///< three mantissas, exponent
  std::uint16_t distance = 0;          ///< binary16 of 1024 d / diagonal; 0: the ray hit nothing
  std::uint16_t flags = 1;             ///< age in the lowest 11 bits, then SampleFlags

  bool operator==(const RadianceSample&) const = default;
};
static_assert(sizeof(RadianceSample) == 8);

enum SampleFlags : std::uint16_t {
  sample_valid = 1 << 11,     ///< a ray was traced; not set if it would have started below the surface
  sample_dynamic = 1 << 12,   ///< the ray hit a mover
  sample_miss = 1 << 13,      ///< the ray hit nothing
  sample_near = 1 << 14,      ///< a close hit: the radiance is not the anchor's light times a constant
  sample_anchored = 1 << 15,  ///< the column `anchor` names the point that represents the hit
};
inline constexpr std::uint16_t kMaxAge = 2047;

inline std::uint16_t age_of(const RadianceSample& s) { return s.flags & kMaxAge; }

/// Radiance of a sample: L = m 2^(e - 136) per channel, 0 if e < 10.
inline std::array<float, 3> decode_rgbe(const std::array<std::uint8_t, 4>& rgbe) {
  const float scale = rgbe[3] < 10 ? 0.0f : std::bit_cast<float>(std::uint32_t(rgbe[3] - 9) << 23);
  return {float(rgbe[0]) * scale, float(rgbe[1]) * scale, float(rgbe[2]) * scale};
}

/// Encodes radiance. The largest mantissa is 128 to 255; each mantissa is floor(L 2^(136 - e) + u) with u in [0, 1).
/// If u is random and uniform, the mean of the decoded value is L. A decoded value is encoded to the same bytes for
/// any u. Values below 0 and NaN become 0, values above 2^126 become 2^126.
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

/// Converts a number to binary16, rounded to nearest, ties to even. Numbers outside 2^-14 to 65504 become the nearer
/// end of this range.
inline std::uint16_t encode_half(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(std::clamp(x, 0x1p-14f, 65504.0f)) - (112u << 23);
  return std::uint16_t((bits + 0xfff + ((bits >> 13) & 1)) >> 13);
}
/// Decodes encode_half(); 0 gives about 0.
inline float decode_half(std::uint16_t h) { return std::bit_cast<float>((std::uint32_t(h) << 13) + (112u << 23)); }

}  // namespace tempolux::formats
