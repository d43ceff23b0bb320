// lib/volume/flight.h -- free flight through media: tentative collisions against a majorant, with random numbers per
// step.
//
// Tentative collisions are distributed as if the extinction were the majorant everywhere. A tentative collision is real
// with probability extinction / majorant; otherwise it is a null collision, and nothing happens (Woodcock et al. 1965).
// Step k of a ray draws its numbers from one word of bits that depends on the ray and on k only. So with a frozen
// majorant a photon looks up the same places when the medium changes, up to its first real collision.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lib/core/random.h"
#include "lib/volume/medium.h"

namespace tempolux {

/// Largest probability with which Russian roulette lets a path continue after a collision. Paths in lossless, unbounded
/// smoke end after a million collisions on average. A smaller value would be wrong: in lossless smoke of optical depth
/// tau paths have up to tau^2 collisions. If most of them ended early, a few paths that are never sampled would carry
/// their light. The value costs little, because paths that enter a convex body uniformly have the mean length 4 (volume
/// / surface area) in it, however they are scattered (Blanco and Fournier 2003).
inline constexpr float kLargestSurvivalInMedia = 0.999999f;

/// The random numbers of one step, from 64 random bits.
struct FlightNumbers {
  float depth;   ///< majorant x distance to the next tentative collision: exponential, mean 1
  float accept;  ///< in [0, 1): the collision is real if accept x majorant < extinction
  explicit FlightNumbers(std::uint64_t bits)
      : depth(-std::log1p(-std::min(float(std::uint32_t(bits >> 32)) * 0x1p-32f, kOneMinus))),
        accept(unit_float(std::uint32_t(bits))) {}

 private:
  static constexpr float kOneMinus = 0x1.fffffep-1f;
};

/// A tentative collision.
struct Tentative {
  float distance;  ///< m from the ray's origin
  float majorant;  ///< 1/m, there
};

/// Steps along a ray segment from one tentative collision to the next.
class Flight {
 public:
  /// `direction` is unit; `length` may be infinite.
  Flight(const MajorantGrid& majorants, Vec3 origin, Vec3 direction, float length)
      : walk_(majorants, origin, direction, length) {
    ended_ = !walk_.next(piece_);
    at_ = piece_.begin;
  }
  /// Advances by `depth` (FlightNumbers) to the next collision; false if the segment ends first.
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

/// Distance [m] of the first real collision along `direction` (unit); INFINITY if the segment of `length` m ends first,
/// which has the probability exp(- optical depth), without bias. bits(k) gives 64 random bits for step k.
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

/// Unbiased estimate, in [0, 1], of the transmittance exp(- optical depth): the product of the probabilities of null
/// collisions (ratio tracking; Novak et al., "Residual ratio tracking", 2014). Below kRouletteBelow Russian roulette
/// follows, so that the cost does not grow with the density. bits(k) gives 64 random bits for step k.
template <class Bits>
float estimate_transmittance(const Media& media, Vec3 origin, Vec3 direction, float length, const Bits& bits) {
  // If the transmittance T is below q = kRouletteBelow, the estimate X is at most q, or was reduced to q in the last
  // step before. So E[X^2] <= q T: at most a tenth of the variance T of an estimate that is 1 without a collision, else
  // 0.
  constexpr float kRouletteBelow = 0.1f;
  Flight flight(media.majorants(), origin, direction, length);
  Tentative t;
  float transmittance = 1;
  for (std::uint32_t k = 0;; ++k) {
    const FlightNumbers numbers(bits(k));
    if (!flight.next(numbers.depth, t)) return transmittance;
    const float before = transmittance;
    transmittance *= std::max(0.0f, 1 - media.extinction(origin + direction * t.distance) / t.majorant);
    if (transmittance >= kRouletteBelow) continue;
    // The path continues with probability transmittance / threshold, and then the estimate is the threshold:
    // kRouletteBelow at the first time, later the estimate before this step.
    const float threshold = std::min(before, kRouletteBelow);
    if (!(numbers.accept * threshold < transmittance)) return 0;
    transmittance = threshold;
  }
}

}  // namespace tempolux
