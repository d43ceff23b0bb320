// lib/irradcache/clearance.h -- the unobstructed part of the surface around a place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lib/core/frame.h"
#include "lib/core/vec.h"

namespace tempolux {

/// How far the surface around a place is unobstructed, along sixteen spokes. Light measured at the place may be used
/// only inside the polygon of the spokes' ends. The polygon follows a straight wall exactly.
struct Clearance {
  /// Spokes point at most 26.6 degrees apart, so the polygon that must hold a disc is only 1.028 times as wide
  /// (kPerRadius; with eight spokes 1.08 times), and the shares fit into two words.
  static constexpr std::uint32_t kSpokes = 16;
  static constexpr std::uint64_t kFull = 255;  ///< share of a spoke that met no obstacle
  using Shares = std::array<std::uint64_t, 2>;
  static constexpr Shares kOpen{~std::uint64_t{0}, ~std::uint64_t{0}};  ///< no spoke met an obstacle
  /// Smallest cosine between the normals of two places of one surface. If the surface bends by more than 45 degrees,
  /// the two places face different halves of the scene and get different light.
  static constexpr float kBend = 0.7f;
  /// Height above the surface that still counts as on the surface, as a share of the distance from the centre [Ward
  /// 1988]. Records are valid up to this height, and spokes rise with this tangent, so that lower obstacles do not end
  /// them.
  static constexpr float kOffPlane = 0.05f;

  float reach = INFINITY;  ///< m: length of an unobstructed spoke
  /// Length of spoke k in 1/255 of reach, rounded down: byte k mod 8 of word k / 8, where byte 0 is the lowest.
  Shares shares = kOpen;

  /// Direction of spoke k in the tangent plane, unit: (1 - f, f) / |(1 - f, f)| with f = (k mod 4) / 4, turned by k / 4
  /// quadrants.
  static Vec2 spoke(std::uint32_t k) {
    const float f = float(k % 4) / 4, x = (1 - f) / kLength[k % 4], y = f / kLength[k % 4];
    switch (k / 4) {
      case 0: return {x, y};
      case 1: return {-y, x};
      case 2: return {-x, -y};
      default: return {y, -x};
    }
  }
  /// Sets the length of spoke k [m]; `reach` must be set.
  void set(std::uint32_t k, float length) {
    const auto share = std::uint64_t(std::clamp(length / reach * float(kFull), 0.0f, float(kFull)));
    std::uint64_t& word = shares[k / 8];
    word = (word & ~(kFull << 8 * (k % 8))) | share << 8 * (k % 8);
  }
  /// A reach of this many radii makes the polygon of unobstructed spokes hold the disc of one radius.
  static constexpr float kPerRadius = 1.0277402f;  // 1 / cos of half of 26.6 degrees, the widest angle between spokes

  /// True if the place at offset `d` [m] from the centre is inside the polygon. `normal`: unit, the normal about which
  /// the spokes were measured. The height of the place above their plane is ignored.
  bool contains(Vec3 d, Vec3 normal) const {
    if (shares == kOpen) return length2(d) < reach * reach;
    const Frame frame(normal);
    float x = dot(d, frame.tangent), y = dot(d, frame.bitangent);
    std::uint32_t first = 0;
    // Turns (x, y) back by quadrants until it is in the first one.
    for (; first < 12 && !(x > 0 && y >= 0); first += 4) x = std::exchange(y, -x);
    const float sum = std::abs(x) + std::abs(y);
    if (!(sum > 0)) return true;
    // d = sum ((1 - t) v_k + t v_k+1), where v_k is the point of spoke k with |x| + |y| = 1 and r_k the spoke's length
    // in multiples of v_k. So d is inside if sum ((1 - t) / r_k + t / r_k+1) < 1.
    const float along = std::min(std::abs(y) / sum * 4, 3.9999998f), t = along - std::floor(along);
    const std::uint32_t k = std::uint32_t(along);
    return sum * ((1 - t) * inverse(first + k, k) + t * inverse((first + k + 1) % kSpokes, (k + 1) % 4)) < reach;
  }
  bool operator==(const Clearance&) const = default;

 private:
  /// |v_k|, where v_k = (1 - f, f) is the point of spoke k with |x| + |y| = 1
  static constexpr std::array<float, 4> kLength{1, 0.79056942f, 0.70710678f, 0.79056942f};
  /// reach / r_k. `of_quadrant`: k mod 4.
  float inverse(std::uint32_t k, std::uint32_t of_quadrant) const {
    return kLength[of_quadrant] * float(kFull) / std::max(float(shares[k / 8] >> 8 * (k % 8) & kFull), 1e-6f);
  }
};

}  // namespace tempolux
