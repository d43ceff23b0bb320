// lib/volume/phase.h -- Henyey-Greenstein phase function.
//
// The formulas of docs/methods/formulas.md are in terms of 1 - cos and do not divide by g, so that forward peaks and
// g = 0 keep their digits. g in (-1, 1) is the mean cosine.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/core/frame.h"
#include "lib/core/sampling.h"

namespace tempolux {

inline constexpr float kLargestG = 1 - 1e-6f;  ///< larger |g| is clamped to this

/// Draws 1 - cos of the angle between the directions of flight before and after a collision, with the pdf pdf_hg(); xi
/// in [0, 1], where 1 gives an unchanged direction if g >= 0, else the opposite.
inline float sample_hg_one_minus_cos(float g, float xi) {
  const float a = std::min(std::abs(g), kLargestG), one_minus_a = 1 - a;
  const float below = one_minus_a + 2 * a * xi;
  const float value = 2 * (1 - xi) * one_minus_a * one_minus_a * (1 + a * xi) / (below * below);
  return std::clamp(g < 0 ? 2 - value : value, 0.0f, 2.0f);
}

/// pdf [1/sr] of scattering at 1 - cos = one_minus_cos, which is the phase function: its integral over the sphere is 1.
/// |a - b|^2 / 2 of the two unit directions of flight is the most exact way to compute 1 - cos.
inline float pdf_hg(float g, float one_minus_cos) {
  const float a = std::min(std::abs(g), kLargestG), one_minus_a = 1 - a;
  const float m = g < 0 ? 2 - one_minus_cos : one_minus_cos;
  const float d = one_minus_a * one_minus_a + 2 * a * std::max(m, 0.0f);
  return (one_minus_a * (1 + a)) / (4 * kPi * d * std::sqrt(d));
}
/// pdf [1/sr] of scattering from one unit direction of flight to another.
inline float pdf_hg(float g, Vec3 before, Vec3 after) { return pdf_hg(g, 0.5f * length2(after - before)); }

/// Draws the unit direction of flight after a collision of light that travelled along `travel` (unit); u in [0, 1)^2.
inline Vec3 sample_hg(float g, Vec3 travel, Vec2 u) {
  const float m = sample_hg_one_minus_cos(g, u.x), sine = std::sqrt(std::max(0.0f, m * (2 - m))), phi = 2 * kPi * u.y;
  return normalize(Frame(travel).to_world({sine * std::cos(phi), sine * std::sin(phi), 1 - m}));
}

}  // namespace tempolux
