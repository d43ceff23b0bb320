// lib/volume/flight.h -- free flight through media: tentative collisions against a majorant, drawn from numbers of
// their own.
//
// A tentative collision happens as if the extinction were the majorant everywhere; it is real with probability
// extinction / majorant, else nothing happens (null collisions; Woodcock et al. 1965). Step k of a way draws its
// numbers from one word of bits that depends on the way and k alone. So under a frozen majorant the places that a
// photon looks at stay the same when the medium changes, up to its first real collision.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lib/core/random.h"
#include "lib/volume/medium.h"

namespace tempolux {

/// Roulette after a collision lets a path go on with this probability at most, so that paths end in lossless smoke that
/// no wall ends: after a million collisions in the mean. Not earlier: in lossless smoke of optical depth tau paths take
/// up to tau^2 collisions, and what ends most of these leaves their light to a few that nobody sees. Nor is it dear:
/// paths that enter a convex body evenly from all sides have a mean way of 4 V / S in it, whatever scatters them there
/// (Blanco and Fournier 2003).
inline constexpr float kLargestSurvivalInMedia = 0.999999f;

/// What one step draws, of 64 random bits.
struct FlightNumbers {
  float depth;   ///< majorant x length to the next tentative collision: exponential, mean 1
  float accept;  ///< in [0, 1): real where accept x majorant < extinction
  explicit FlightNumbers(std::uint64_t bits)
      : depth(-std::log1p(-std::min(float(std::uint32_t(bits >> 32)) * 0x1p-32f, kOneMinus))),
        accept(unit_float(std::uint32_t(bits))) {}

 private:
  static constexpr float kOneMinus = 0x1.fffffep-1f;
};

struct Tentative {
  float distance;  ///< m from the way's origin
  float majorant;  ///< 1/m, there
};

/// A way, from one tentative collision to the next.
class Flight {
 public:
  /// `direction` is unit; `length` may be infinite.
  Flight(const MajorantGrid& majorants, Vec3 origin, Vec3 direction, float length)
      : walk_(majorants, origin, direction, length) {
    ended_ = !walk_.next(piece_);
    at_ = piece_.begin;
  }
  /// The next one, `depth` (FlightNumbers) farther; false if the way ends before.
  bool next(float depth, Tentative& found) {
    while (!ended_) {
      const float reach = (piece_.end - at_) * piece_.majorant;
      if (depth < reach) {
        at_ = std::min(at_ + depth / piece_.majorant, piece_.end);
        found = {at_, piece_.majorant};
        return true;
      }
      depth -= reach;
      ended_ = !walk_.next(piece_);
      at_ = piece_.begin;
    }
    return false;
  }

 private:
  MajorantWalk walk_;
  MajorantWalk::Piece piece_{0, 0, 0};
  float at_ = 0;
  bool ended_ = true;
};

/// Distance [m] of the first real collision; INFINITY if the way ends before. `bits(k)`: 64 random bits of step k.
/// Probability of passing: exp(- optical depth), exactly in the mean.
template <class Bits>
float first_collision(const Media& media, Vec3 origin, Vec3 direction, float length, const Bits& bits) {
  Flight flight(media.majorants(), origin, direction, length);
  Tentative t;
  for (std::uint32_t k = 0;; ++k) {
    const FlightNumbers numbers(bits(k));
    if (!flight.next(numbers.depth, t)) return INFINITY;
    if (numbers.accept * t.majorant < media.extinction(origin + direction * t.distance)) return t.distance;
  }
}

/// Share of light left after the way, in [0, 1]: an estimate whose mean is exp(- optical depth). Product of the null
/// collisions' probabilities (ratio tracking; Novak et al., "Residual ratio tracking", 2014); below a tenth by
/// roulette, so that dense media do not cost more and more.
template <class Bits>
float estimate_transmittance(const Media& media, Vec3 origin, Vec3 direction, float length, const Bits& bits) {
  constexpr float kRouletteBelow = 0.1f;
  Flight flight(media.majorants(), origin, direction, length);
  Tentative t;
  float left = 1;
  for (std::uint32_t k = 0;; ++k) {
    const FlightNumbers numbers(bits(k));
    if (!flight.next(numbers.depth, t)) return left;
    const float before = left;
    left *= std::max(0.0f, 1 - media.extinction(origin + direction * t.distance) / t.majorant);
    if (left >= kRouletteBelow) continue;
    // Above the threshold a tenth survives by left / threshold; once below, by what this step has left over.
    const float threshold = std::min(before, kRouletteBelow);
    if (!(numbers.accept * threshold < left)) return 0;
    left = threshold;
  }
}

}  // namespace tempolux
