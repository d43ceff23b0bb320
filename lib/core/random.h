// lib/core/random.h -- counter-based random numbers: each is a pure function of its purpose.
//
// There is no generator state: the number for (seed, photon, bounce, purpose) does not depend on numbers drawn before
// or on the thread. So files are equal for any --threads, and two traces of one photon through two scenes stay equal up
// to the point where the scenes differ.
#pragma once

#include <bit>
#include <cstdint>

#include "lib/core/vec.h"

namespace tempolux {

/// The purpose of a random number; part of its key, so that no two purposes share numbers.
enum class Purpose : std::uint32_t {
  emit = 1,
  lobe,
  scatter,
  roulette,
  light_choice,
  light_point,
  pixel,
  scramble,
  gather,
  points,
  place,
  test,
  flight,
  medium,
  phase,
  sun,
  lens,
  side,
  wavelength
};

/// Finaliser with full avalanche on 64 bits (Stafford's mix 13, as in SplitMix64).
constexpr std::uint64_t mix64(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// 24 bits of u as a float in [0, 1): never 1.
constexpr float unit_float(std::uint32_t u) { return float(u >> 8) * 0x1p-24f; }
/// 53 bits of u as a double in [0, 1).
constexpr double unit_double(std::uint64_t u) { return double(u >> 11) * 0x1p-53; }

/// The random numbers of one path; key = (seed, index of the photon or pixel sample).
class PathRandom {
 public:
  constexpr PathRandom(std::uint64_t seed, std::uint64_t index)
      : key_(mix64(mix64(seed + 0x9e3779b97f4a7c15ull) + index * 0xd1342543de82ef95ull + 0x632be59bd9b4e019ull)) {}

  /// 64 random bits for one (bounce, purpose, extra).
  constexpr std::uint64_t bits(std::uint32_t bounce, Purpose purpose, std::uint32_t extra = 0) const {
    return mix64(key_ ^
                 mix64((std::uint64_t(bounce) << 32 | std::uint64_t(purpose) << 24 | extra) + 0x9e3779b97f4a7c15ull));
  }
  /// One number in [0, 1).
  constexpr float get1(std::uint32_t bounce, Purpose purpose, std::uint32_t extra = 0) const {
    return unit_float(std::uint32_t(bits(bounce, purpose, extra) >> 32));
  }
  /// Two numbers in [0, 1).
  constexpr Vec2 get2(std::uint32_t bounce, Purpose purpose, std::uint32_t extra = 0) const {
    const std::uint64_t b = bits(bounce, purpose, extra);
    return {unit_float(std::uint32_t(b >> 32)), unit_float(std::uint32_t(b))};
  }

 private:
  std::uint64_t key_;
};

/// Key of the random numbers of a place: a hash of seed, position and normal. So a record or point does not depend on
/// records or points at other places.
inline std::uint64_t place_key(Vec3 position, Vec3 normal, std::uint64_t seed) {
  std::uint64_t key = mix64(seed + 0x6761746865720001ull);
  for (const float x : {position.x, position.y, position.z, normal.x, normal.y, normal.z})
    key = mix64(key ^ std::bit_cast<std::uint32_t>(x));
  return key;
}

}  // namespace tempolux
